"""A machine has the same branches in every unit: its motions are thousands of micrometres, or thousandths of a metre."""

import math

import pytest
from scipy.optimize import brentq

import contvines as cv
from orbits.simulation import replay
from orbits.symbols import cos
from tests.orbits.declared.oscillators import RIGHT, oscillator

pytest.importorskip("pint")

MASS, STIFFNESS, DAMPING, FORCE, GAP = 4.0, 16e3, 12.0, 40.0, 8e-3
METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6}


def press(length, speed):
    """A mass of 4 kg on a spring beside a wall at 8 mm, driven by 40 N."""
    return oscillator(
        lambda s, phase, p, contact: (FORCE * cos(phase) - DAMPING * s.v - STIFFNESS * s.x) / MASS,
        RIGHT,
        parameters={"gap": "0.8 cm", "frequency": "9 Hz", "restitution": 0.6},
        units={"x": length, "v": speed, "gap": length, "frequency": "Hz"},
    )


def size(hertz):
    """Metres that it goes to either side without the wall."""
    rate = 2.0 * math.pi * hertz
    return FORCE / abs(STIFFNESS - MASS * rate**2 + 1j * DAMPING * rate)


@pytest.mark.slow
@pytest.mark.parametrize(("length", "speed"), [("m", "m/s"), ("mm", "mm/s"), ("mm", "m/s"), ("um", "um/s")])
def test_the_branch_ends_where_the_linear_response_reaches_the_wall(length, speed):
    start = press(length, speed).orbit("R", frequency=10.0)
    graph = cv.diagram(start, over="frequency", within=(8.0, 11.5), depth=0)
    assert set(graph.special) == {"WG1", "PD1", "EP1", "EP2"}
    assert graph["WG1"].value == pytest.approx(brentq(lambda f: size(f) - GAP, 8.0, 10.0), rel=1e-9)
    assert not graph.unresolved and len(graph["B1"]) < 500


@pytest.mark.parametrize(("length", "speed"), [("m", "m/s"), ("mm", "mm/s")])
def test_what_simulation_meets_lies_on_its_branch(length, speed):
    """At 8.5 Hz, where all starts lead to two impacts in three periods, and far above the resonance, where few lead to the linear response and the
    others to impacts."""

    def met(at):
        within = (at - 0.02, at + 0.02)
        options = {"over": "frequency", "within": within, "values": [at], "starts": 32, "scan": 0, "depth": 0}
        return cv.atlas(press(length, speed), **options)

    (doubled,) = met(8.5).attractors
    assert (doubled.word, doubled.periods, doubled.branch) == ("RR", 3, "B1")
    atlas = met(12.5)
    assert sorted((about.word, about.branch) for about in atlas.attractors) == [("", "B2"), ("R", "B1")]
    orbit = atlas["B2"].orbit(1)
    most = size(orbit.parameters["frequency"])
    assert orbit.measure("max_x") == pytest.approx(most / METRES[length], rel=1e-9)
    assert orbit.model.units["max_x"] == length and replay(orbit).error < 1e-9
    # it comes closest to the wall inside its flight
    kept = min(margin.value for margin in orbit.margins if margin.kind == "wall")
    assert kept == pytest.approx(GAP - most, rel=1e-8)
