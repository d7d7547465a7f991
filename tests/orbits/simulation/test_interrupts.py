"""An interrupt ends work in native loops that would last for minutes: the loops return to Python in between."""

import signal
import threading

import numpy as np
import pytest

from orbits import Absorber, Coupled
from orbits.design.record import recorded
from orbits.flows import simulator_of
from orbits.flows.native.batches import lyapunov
from tests.machines import ABSORBER, COUPLED

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread(),
        reason="needs a timer that interrupts the main thread",
    ),
]
PARAMS = ABSORBER.vector({"amplitude": 0.55})
TIMES = np.arange(0.0, 1e6, 0.5)
# swings slowly below its absorber, which friction holds for ever
HELD = Coupled(
    restitution=0.5, friction=1.0, gravity=1.0, mass_ratio=0.1, damping=0.01, forcing=0.3, frequency=0.02
)
FREE = Absorber(restitution=1.0, friction=0.0, gravity=0.2)


def simulator(model, start, **values):
    found = simulator_of(model, model.vector(values))
    found.put(start)
    return found


def many_starts(model, workers, **values):
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (10**5, model.node + 1))
    simulator(model, None, **values).settle_all(points, 24, workers)


@pytest.mark.parametrize(
    "work",
    [
        lambda: many_starts(ABSORBER, 1, amplitude=1.5),
        lambda: many_starts(ABSORBER, 2, amplitude=1.5),
        lambda: many_starts(COUPLED, 1, frequency=1.0),
        lambda: lyapunov("absorber", simulator(ABSORBER, {"w_rate": 1.0}, amplitude=0.55).state, PARAMS, 10**6),
        lambda: simulator(HELD, {"w": 0.3}).skip(1e7),
        lambda: simulator(FREE, {"w_rate": 1e-7}, amplitude=1e-9).skip(1e6),
        lambda: recorded(COUPLED, COUPLED.vector({"frequency": 1.0}), TIMES, np.sin(TIMES) * np.sin(0.1 * TIMES)),
    ],
)  # fmt: skip
def test_an_interrupt_ends_a_native_loop(work):
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            while True:
                work()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
