"""`contvines ...` in a process that strikes itself, by SIGKILL or SIGINT, at a chosen write to its file.

Usage: python killer.py BLOW WHERE WRITES LOG ARGUMENTS...   WHERE: "before" the write, "inside" its transaction, "after" it,
or "look": when a finished diagram is looked over for what it does not have.
The key of every journal record is appended to LOG as soon as the record is said to be kept.
"""

import os
import sys

from contvines.coexistence import census
from contvines.command.cli import main
from contvines.shared.row_journal import Rows
from contvines.store import Store

blow, chosen, writes, log = int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4]
count = 0


def strike(where):
    if where == chosen and count >= writes:
        os.kill(os.getpid(), blow)


def struck(owner, name, counts=True):
    method = getattr(owner, name)

    def wrapped(self, *arguments):
        global count
        count += counts
        strike("before")
        method(self, *arguments)
        if name == "record":
            with open(log, "a") as file:
                file.write(f"{arguments[0]}\n")
        strike("after" if counts else "inside")

    setattr(owner, name, wrapped)


struck(Store, "put", counts=False)
for owner, name in ((Store, "record"), (Store, "checkpoint"), (Rows, "keep")):
    struck(owner, name)
if chosen == "look":
    census.census = lambda *_: strike("look")
main(sys.argv[5:])
