"""Processes that tests start: they have default signals and a deadline, and end with the test, however that ends.

A suite that is started by a shell as a background job ignores Ctrl-C, and so would all its children.
"""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, ClassVar
from weakref import WeakSet

import pytest

DEADLINE = 600  # seconds; no child needs as many, and the limit of a whole test is longer
TESTS = str(Path(__file__).parent)

# What a child does before its program begins, in a process of its own: a function that `subprocess` calls between fork and exec
# runs beside locks of the test's other threads, which nobody gives back there.
BORN = """
import os, signal, sys
signal.alarm(int(sys.argv[1]))
for number in (signal.SIGPIPE, signal.SIGXFSZ):
    signal.signal(number, signal.SIG_DFL)
if sys.platform == "linux":
    import ctypes
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != int(sys.argv[2]):
        sys.exit("the test has ended")
os.execvp(sys.argv[3], sys.argv[3:])
"""


class Child(subprocess.Popen):
    """What `subprocess.Popen` and `subprocess.run` start in a test; what libraries start is left alone."""

    known: ClassVar[WeakSet[Any]] = WeakSet()

    def __init__(self, args, *more, **options):
        own = os.name == "posix" and _asked_by_a_test()
        if own:
            args = [sys.executable, "-I", "-S", "-c", BORN, str(DEADLINE), str(os.getpid()), *args]
        super().__init__(args, *more, **options)
        if own:
            Child.known.add(self)


def _asked_by_a_test() -> bool:
    frame = sys._getframe(2)
    while frame is not None and frame.f_code.co_filename in (subprocess.__file__, __file__):
        frame = frame.f_back
    return frame is not None and frame.f_code.co_filename.startswith(TESTS)


def adopt() -> None:
    """Default signals for the tests themselves, and for all that they start."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    subprocess.Popen = Child


@pytest.fixture(autouse=True)
def no_child_survives_its_test():
    """End what a test has started and left."""
    before = set(Child.known)
    yield
    for child in set(Child.known) - before:
        if child.poll() is None:
            child.kill()
            child.wait()
