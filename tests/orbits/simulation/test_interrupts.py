"""An interrupt ends work in native loops that would last for minutes: the loops return to Python in between."""

import signal
import threading

import numpy as np
import pytest

from orbits import Absorber, Coupled
from orbits.design import record
from orbits.flows.native import batches
from orbits.flows.native.simulator import first_state, skip
from orbits.machines.names import usual
from orbits.machines.native_stepper import stepper

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread(),
        reason="needs a timer that interrupts the main thread",
    ),
]


def many_starts(name, workers):
    model, given = usual(name)
    engine = stepper(name)
    states = np.zeros((10**5, engine.state))
    states[:, :3] = np.random.default_rng(0).uniform([0, -1, -1], [6, 1, 1], (10**5, 3))
    batches.settle_all(
        name, states, model.vector(given), transients=(3e3,), longest=24, tolerance=0.0, workers=workers
    )


def growth():
    model, given = usual("absorber")
    engine, params = stepper("absorber"), model.vector(given)
    state = first_state(model, engine, params, {"w_rate": 1.0})
    while True:
        batches.lyapunov("absorber", state, params, periods=10**6)


def without_events():
    """An oscillator that swings slowly below its absorber, which friction holds for ever."""
    model = Coupled(
        restitution=0.5, friction=1.0, gravity=1.0, mass_ratio=0.1, damping=0.01, forcing=0.3, frequency=0.02
    )
    engine, params = stepper("coupled"), model.vector({})
    while True:
        skip(engine, first_state(model, engine, params, {"w": 0.3}), params, 1e7, 10**9)


def slow_drift():
    model = Absorber(restitution=1.0, friction=0.0, gravity=0.2)
    engine, params = stepper("absorber"), model.vector({"amplitude": 1e-9})
    while True:
        skip(engine, first_state(model, engine, params, {"w_rate": 1e-7}), params, 1e6, 10**9)


def long_record():
    times = np.arange(0.0, 1e6, 0.5)
    model = Coupled(restitution=0.3, friction=0.4, gravity=0.5, mass_ratio=0.1, damping=0.8, forcing=1.0)
    while True:
        record.recorded(model, model.vector(), times, np.sin(times) * np.sin(0.1 * times))


@pytest.mark.parametrize(
    "work",
    [
        lambda: many_starts("absorber", 1),
        lambda: many_starts("absorber", 2),
        lambda: many_starts("coupled", 1),
        growth,
        without_events,
        slow_drift,
        long_record,
    ],
)
def test_an_interrupt_ends_a_native_loop(work):
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
