"""A page with units is the page without them in SI numbers: the same motions, shown in other units."""

import numpy as np
import pytest

from orbits import Machine, Wall
from orbits.symbols import cos

pytest.importorskip("pint")
STATES = ("x", "v")
SI = {
    "stiffness": 900.0,
    "force": 2.0,
    "gap": 1.5e-3,
    "frequency": 2 * np.pi * 5.5,
    "damping": 4.0,
    "restitution": 0.8,
}
SHOWN = SI | {"gap": "1.5 mm", "frequency": 5.5, "stiffness": "0.9 N/mm"}
UNITS = {"x": "mm", "v": "mm/s", "gap": "mm", "frequency": "Hz", "stiffness": "N/m", "force": "N"}


def stop(parameters, units=None):
    def motion(state, phase, p, contact):
        x, v = state
        return v, p.force * cos(phase) - p.stiffness * x - p.damping * v  # a mass of one kilogram

    wall = Wall("R", lambda state, phase, p: p.gap - state.x, {"v": -1.0}, "restitution")
    return Machine(
        name="stop",
        states=STATES,
        parameters=parameters,
        motion=motion,
        contacts=[wall],
        phase_rate="frequency",
        units=units,
    )


def test_motions_are_the_same_in_every_unit():
    plain, shown = stop(SI).attractor().found, stop(SHOWN, UNITS).attractor().found
    assert (
        shown.word == plain.word and shown.impacts and shown.period == pytest.approx(plain.period, rel=1e-12)
    )
    assert shown.nodes == pytest.approx(plain.nodes * [1.0, 1e3, 1e3], abs=1e-9)
    assert np.abs(shown.multipliers) == pytest.approx(np.abs(plain.multipliers), abs=1e-10)
    assert shown.measure("max_x") == pytest.approx(1e3 * plain.measure("max_x"), rel=1e-12)
    assert shown.model.units["max_x"] == "mm" and shown.model.units["frequency"] == "Hz"
