"""Ctrl-C in Python ends what it interrupts, wherever it comes: also while compiled code has called Python back."""

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from orbits.compiling.interrupts import kept_back

CHILD = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
import contvines as cv
from orbits import Absorber, Coupled
from orbits.attractors import find_attractor, sweep
machine = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
coupled = Coupled(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, damping=0.9, forcing=2.0, frequency=1.0)
long = coupled.symmetric_orbit().repeat(200)  # its multipliers are asked of Python
graph = cv.diagram(machine.symmetric_orbit(amplitude=0.6), over="amplitude", within=(0.55, 0.8), depth=0)

def multipliers():
    type(long)(long.model, long.word, long.periods, long.nodes, long.params).multipliers

def margins():
    type(long)(long.model, long.word, long.periods, long.nodes, long.params).margins

def attractor():
    find_attractor(machine, amplitude=0.6)

def swept():
    sweep(machine, "amplitude", [0.4, 0.5, 0.6])

def traced():
    cv.diagram(long, over="frequency", within=(0.999, 1.001), depth=0)

def locus():
    cv.locus(graph.of_kind("symmetry-breaking")[0], over="friction", within=(0.4, 0.6))

def basins():
    cv.basins(machine, over="amplitude", at=0.6, points=20)

for work in [multipliers, margins, attractor, swept, traced, locus, basins] * int(sys.argv[1]):
    work()
    print("ready", flush=True)
    try:
        while True:
            work()
    except KeyboardInterrupt:
        print("interrupted", work.__name__, flush=True)
"""
WORKS = ["multipliers", "margins", "attractor", "swept", "traced", "locus", "basins"]


def test_an_interrupt_at_any_time_ends_the_work():
    """The loop around each work would go on for ever if an interrupt was ignored."""
    tries = int(os.environ.get("CONTVINES_TRIES", "1"))
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(tries)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    guard = threading.Timer(900.0, child.kill)
    guard.start()
    try:
        for delay, work in zip(np.random.default_rng(3).uniform(0.0, 0.3, 7 * tries), WORKS * tries):
            assert child.stdout.readline() == "ready\n", work
            time.sleep(delay)
            child.send_signal(signal.SIGINT)
            assert child.stdout.readline() == f"interrupted {work}\n"
        assert child.communicate(timeout=600) == ("", "")
    finally:
        guard.cancel()
        child.kill()


@ctypes.CFUNCTYPE(None)
def called_back():
    signal.raise_signal(signal.SIGINT)


def test_an_interrupt_in_a_callback_waits_for_the_end(capfd):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        reached = False
        with pytest.raises(KeyboardInterrupt):
            with kept_back():
                called_back()  # raised in here it could only be ignored
                reached = True
            raise AssertionError("the result was used")
        assert reached
        assert capfd.readouterr().err == ""
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_handler_of_the_users_own_hears_of_it_and_other_threads_are_left_alone():
    heard = []
    before = signal.signal(signal.SIGINT, lambda *_: heard.append("mine"))
    try:
        with kept_back():
            called_back()
            assert not heard
        assert heard == ["mine"]
        worker = threading.Thread(
            target=lambda: [heard.append("worker") for _ in [1]] if not kept() else None
        )
        worker.start()
        worker.join()
        assert heard == ["mine", "worker"]
    finally:
        signal.signal(signal.SIGINT, before)


def kept():
    with kept_back():
        return False
