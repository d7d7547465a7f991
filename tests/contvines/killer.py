"""`contvines ...` in a process that kills itself, by SIGKILL, at a chosen write to its file.

Usage: python killer.py WRITES WHERE LOG ARGUMENTS...   WHERE: "before" the write, "inside" its transaction, "after" it.
The key of every journal record is appended to LOG as soon as the record is said to be kept.
"""

import os
import signal
import sys

from contvines.command.cli import main
from contvines.store import Store

writes, where, log = int(sys.argv[1]), sys.argv[2], sys.argv[3]
put, record, checkpoint = Store.put, Store.record, Store.checkpoint
count = 0


def die():
    os.kill(os.getpid(), signal.SIGKILL)


def counted_put(self, kind, key, content):
    put(self, kind, key, content)
    if where == "inside" and count >= writes:
        die()


def counted(method):
    def wrapped(self, *arguments):
        global count
        count += 1
        if where == "before" and count >= writes:
            die()
        method(self, *arguments)
        if len(arguments) == 2:
            with open(log, "a") as file:
                file.write(f"{arguments[0]}\n")
        if where == "after" and count >= writes:
            die()

    return wrapped


Store.put, Store.record, Store.checkpoint = counted_put, counted(record), counted(checkpoint)
main(sys.argv[4:])
