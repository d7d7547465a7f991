"""Ctrl-C is not lost where Python can only ignore it: in a callback that compiled code calls."""

import ctypes
import signal
import subprocess
import sys
import threading
import time
from functools import partial

import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.long_work import HELD, OPEN, listening, wanted
from tests.machines import absorber_graph

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
    _, said = process.communicate(timeout=600)
    assert process.returncode == 130
    assert "Traceback" not in said and said.startswith("contvines: stopped")


# ------------------------------------------------------------------ in Python


@ctypes.CFUNCTYPE(None)
def ignoring():
    signal.raise_signal(signal.SIGINT)


def test_a_held_section_keeps_an_interrupt_back_until_its_end(capfd):
    reached = []
    with pytest.raises(KeyboardInterrupt), listening():
        with HELD:
            ignoring()  # raised in here it could only be ignored
            reached.append("the end of the section")
        reached.append("behind the section")
    assert reached == ["the end of the section"]
    assert capfd.readouterr().err == ""
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_interrupt_that_was_ignored_in_an_open_section_is_raised_at_its_end(monkeypatch):
    ignored = []
    monkeypatch.setattr(sys, "unraisablehook", ignored.append)
    with pytest.raises(KeyboardInterrupt), listening():
        with OPEN:
            ignoring()
        raise AssertionError("the section's result was used")
    assert len(ignored) == 1


def test_elsewhere_an_interrupt_is_raised_at_once_and_only_once():
    with pytest.raises(KeyboardInterrupt), listening():
        signal.raise_signal(signal.SIGINT)
        raise AssertionError("not at once")
    with listening(), HELD, OPEN:
        pass  # nothing is left over


def test_sections_of_other_threads_neither_keep_an_interrupt_back_nor_take_it():
    begun, end = threading.Event(), threading.Event()
    taken = []

    def work():
        with HELD:
            begun.set()
            end.wait()
            taken.append(wanted())

    thread = threading.Thread(target=work)
    thread.start()
    begun.wait()
    try:
        with pytest.raises(KeyboardInterrupt), listening():
            with HELD:
                signal.raise_signal(signal.SIGINT)
                end.set()
                thread.join()
            raise AssertionError("kept back beyond the section of this thread")
    finally:
        end.set()
    assert taken == [False]


MOMENTS = """
import signal, sys, threading
from contvines.long_work import HELD, OPEN, listening

def work():
    with listening():
        with HELD, OPEN:
            pass
        with OPEN:
            pass
    with HELD:
        pass

def press():
    while True:
        asked.wait()
        asked.clear()
        for _ in range(n % 7):
            pass
        signal.raise_signal(signal.SIGINT)

asked, left = threading.Event(), 0
sys.setswitchinterval(1e-6)  # the other thread gets its turn wherever an interrupt may come
threading.Thread(target=press, daemon=True).start()
for n in range(5000):
    try:
        asked.set()
        while True:
            work()
    except KeyboardInterrupt:
        pass
    try:
        work()  # nothing is left over
    except KeyboardInterrupt:
        left += 1
    left += signal.getsignal(signal.SIGINT) is not signal.default_int_handler
print(left)
"""


def test_an_interrupt_where_a_section_begins_or_ends_leaves_nothing_over():
    done = subprocess.run([sys.executable, "-c", MOMENTS], capture_output=True, text=True, check=True)
    assert done.stdout == "0\n"


def test_a_handler_of_the_users_own_is_left_alone():
    seen = []
    before = signal.signal(signal.SIGINT, lambda *_: seen.append("mine"))
    try:
        with listening(), HELD:
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == ["mine"]


@pytest.mark.parametrize("where", ["memory", "file"])
def test_interrupted_at_many_moments_a_diagram_ends_as_the_undisturbed_one(tmp_path, where):
    """Every interrupt ends the run; what was recorded until then is right; the last run has the same graph, bit for bit."""
    made = partial(absorber_graph, 0.6, (0.17, 1.27), depth=2)
    whole = made()
    journal = cv.MemoryJournal() if where == "memory" else cv.resume(tmp_path / "x.vines")
    rounds = 0
    for delay in (0.01, 0.03, 0.05, 0.07, 0.09, 0.11, 0.13, 0.15):
        timer = threading.Timer(delay, signal.raise_signal, [signal.SIGINT])
        try:
            timer.start()  # on a loaded machine the interrupt may come in here
            made(journal=journal)
            timer.join()
            time.sleep(0.01)  # too late for this run: it comes here
        except KeyboardInterrupt:
            rounds += 1
        else:
            break
    assert rounds >= 3
    assert same_graph(made(journal=journal), whole)


def test_an_interrupt_inside_a_write_leaves_no_transaction_open(tmp_path):
    with cv.resume(tmp_path / "x.vines") as store:
        with pytest.raises(KeyboardInterrupt), store.transaction():
            store.put("journal", "lost", {"x": 1})
            raise KeyboardInterrupt
        store._db.execute("BEGIN")  # as left by an interrupt between two instructions
        store.record("kept", {"x": 2})
        assert store.recall("lost") is None and store.recall("kept") == {"x": 2}


def test_what_was_not_written_is_written_again(tmp_path):
    """A checkpoint that is rolled back has kept nothing: the next one writes everything."""
    graph = cv.diagram(cv.AlgebraicProblem(lambda u, p: u - p, [0.0]), within=(-1.0, 1.0))
    with cv.resume(tmp_path / "x.vines") as store:
        put = store.put

        def once(kind, key, content):
            put(kind, key, content)
            if kind == "special":
                raise KeyboardInterrupt

        store.put = once
        with pytest.raises(KeyboardInterrupt):
            store.checkpoint(graph)
        store.put = put
        store.checkpoint(graph)
    kept = cv.load(tmp_path / "x.vines", problems=False)
    assert isinstance(kept, cv.Graph) and same_graph(kept, graph)
