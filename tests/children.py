"""Processes that tests start: they have default signals and a deadline, and end with the test, however that ends.

A suite that is started by a shell as a background job ignores Ctrl-C, and so would all its children.
"""

import ctypes
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, ClassVar
from weakref import WeakSet

import pytest

DEADLINE = 900  # seconds; no test needs as many
TESTS = str(Path(__file__).parent)
_libc = ctypes.CDLL(None) if sys.platform == "linux" else None
_PR_SET_PDEATHSIG = 1


def _born() -> None:
    """What a child does before its program begins."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.alarm(DEADLINE)
    if _libc is not None:
        _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


class Child(subprocess.Popen):
    """What `subprocess.Popen` and `subprocess.run` start in a test; what libraries start is left alone."""

    known: ClassVar[WeakSet[Any]] = WeakSet()

    def __init__(self, *words, **options):
        own = os.name == "posix" and _asked_by_a_test()
        if own and options.get("preexec_fn") is None:
            options["preexec_fn"] = _born
        super().__init__(*words, **options)
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
