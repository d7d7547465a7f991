"""Slow impacts beside a force that hardly presses: a body on a rough floor, with a wall before it and a second spring behind it, in millimetres."""

import numpy as np
import pytest

from orbits import Switch
from orbits.symbols import cos
from tests.orbits.declared.oscillators import FLOOR, RIGHT, oscillator

pytest.importorskip("pint")


def test_nothing_is_passed_over_on_a_long_hop():
    """By DOP853 from event to event, 60 periods from rest: 6.2093 mm, two impacts, a turn behind each, and one at either end of the second spring."""

    def force(s, phase, p, contact):
        behind = 1500.0 * (s.x + 4e-3) * (1 - contact.soft) / 2
        return (3.0 * cos(phase) - 700.0 * s.x - 1.5 * s.v - behind) / 0.8 + contact.floor

    machine = oscillator(
        force, RIGHT, FLOOR, Switch("soft", lambda s, phase, p: s.x + 4e-3),
        parameters={"frequency": 3.0, "gap": 2.2, "restitution": 0.65, "friction": 0.05 * 9.81},
        units={"x": "mm", "v": "mm/s", "gap": "mm", "frequency": "Hz"},
    )  # fmt: skip
    run = machine.simulate({"x": 0.0}, periods=40)
    assert run.sample(np.linspace(0.0, run.finish, 20_000))[:, 0].max() < 2.2 + 1e-9
    found = machine.attractor()
    assert (found.periods, len(found.orbit.word)) == (1, 8) and found.orbit.impacts == 2
    assert found.orbit.measure("max_abs_x") == pytest.approx(6.2093, abs=1e-4)
