"""Work spread over processes: every result once, a lost process loses its own piece alone, none is left behind."""

import os
import subprocess
import sys
import threading
import time

import pytest

from contvines.shared.processes import ATTEMPTS, may_be_copied, spread
from tests.pieces import deadly, square, wrong


def never(place):
    raise AssertionError(f"piece {place} is said to be lost")


def run(program):
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("count", [1, 3])
def test_every_piece_is_done_once_and_not_here(count):
    found = list(spread(square, [(n,) for n in range(40)], count, never))
    assert sorted((place, value) for place, (value, _) in found) == [(n, n * n) for n in range(40)]
    doers = {doer for _, (_, doer) in found}
    assert os.getpid() not in doers and len(doers) <= count
    assert list(spread(square, [], count, never)) == []


def test_only_what_ends_its_process_is_lost(tmp_path):
    pieces = [(n, tmp_path) for n in range(1, 16)]
    found = dict(spread(deadly, pieces, 2, lambda place: f"lost {place}"))
    assert found == {n - 1: f"lost {n - 1}" if n % 7 == 0 else n * n for n in range(1, 16)}
    begun = {n: len((tmp_path / str(n)).read_text().splitlines()) for n in range(1, 16)}
    assert begun == {n: ATTEMPTS if n % 7 == 0 else 2 if n == 3 else 1 for n in range(1, 16)}


def test_errors_come_back_as_they_are():
    with pytest.raises(KeyError, match="5 is no good") as caught:
        list(spread(wrong, [(5,)], 1, never))
    assert "in wrong" in caught.value.__notes__[0]  # where it happened
    with pytest.raises((AttributeError, TypeError), match="lambda"):
        list(spread(wrong, [(4,)], 1, never))


def test_no_copies_beside_a_thread():
    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        assert not may_be_copied()
    finally:
        stop.set()
        thread.join()


# Copies know what the process knows, without a guard of `__main__`, too
COPIED = """
import sys
import numpy, scipy.linalg  # they have threads of their own, where there are several cores
numpy.linalg.eig(numpy.random.rand(300, 300))
from contvines.shared.processes import may_be_copied, spread
here = 1
def told(n):
    return here + n
here = 40
print(may_be_copied(), sorted(spread(told, [(1,), (2,)], 2, lambda place: "lost")))
"""
# No copies beside a thread that Python does not know
NATIVE = """
import ctypes, sys
from contvines.shared.processes import may_be_copied
libc = ctypes.CDLL(None)
waits = ctypes.cast(libc.pause, ctypes.c_void_p)
print(libc.pthread_create(ctypes.byref(ctypes.c_ulong()), None, waits, None), may_be_copied())
"""
# No copies where one does not even end
STUCK = """
import ctypes, os, threading
from contvines.shared import processes
processes.PATIENCE = 0.1
libc = ctypes.CDLL(None)
libc.pthread_create(ctypes.byref(ctypes.c_ulong()), None, ctypes.cast(libc.pause, ctypes.c_void_p), None)
os.register_at_fork(after_in_child=threading.Event().wait)
print(processes.may_be_copied())
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="copies are made on Linux alone")
@pytest.mark.parametrize(
    ("program", "says"), [(COPIED, "True [(0, 41), (1, 42)]"), (NATIVE, "0 False"), (STUCK, "False")]
)
def test_when_processes_are_copies(program, says):
    assert run(program).stdout == says + "\n"


KILLED = """
import os, signal, sys, time
from contvines.shared.processes import spread
from tests.pieces import square
if __name__ == "__main__":
    for place, (_, doer) in spread(square, [(n,) for n in range(9)], 2, None):
        print(doer, flush=True)
        if place > 4:
            os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_process_leaves_no_workers():
    done = run(KILLED)
    workers = {int(line) for line in done.stdout.split()}
    assert workers and done.returncode < 0
    deadline = time.monotonic() + 300.0
    while any(os.path.exists(f"/proc/{worker}") for worker in workers) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(os.path.exists(f"/proc/{worker}") for worker in workers)


def test_workers_end_when_the_iteration_is_left():
    results = spread(square, [(n,) for n in range(9)], 2, never)
    _, (_, doer) = next(results)
    results.close()
    assert not os.path.exists(f"/proc/{doer}")
