"""Ctrl-C is not lost where Python can only ignore it: in a callback that compiled code calls."""

import signal
import subprocess
import sys
import time

PROGRAM = """
import ctypes, signal, sys
from contvines.command import entry

def work():
    print("working", flush=True)
    while True:
        callback()  # four fifths of the time are spent in here
        count(20_000)

def count(n):
    total = 0
    for i in range(n):
        total += i

@ctypes.PYFUNCTYPE(None)
def callback():
    count(80_000)

import contvines.command.cli
contvines.command.cli.main = work
entry.main()
"""


def test_an_interrupt_inside_a_callback_is_given_again():
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in said and said.startswith("contvines: stopped")
