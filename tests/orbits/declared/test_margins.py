"""Margins of motions in a machine file: what a flight comes closest to between its ends, and motions that come back shifted."""

from types import SimpleNamespace

import numpy as np
import pytest

from orbits import Machine, Wall
from orbits.flows.page.margins import fill_margins
from orbits.symbols import cos

pytest.importorskip("heyoka")

FORCING, FREQUENCY, DAMPING, GAP = 0.3, 0.7, 0.1, 2.0


def motion(state, phase, p, contact):
    x, v = state
    return v, p.forcing * cos(phase) - 2 * p.damping * v - x


def test_the_closest_approach_to_a_wall_lies_inside_the_flight():
    """A linear oscillator that does not reach its wall keeps the gap less its amplitude F/|1 - W^2 + 2 i d W|."""
    machine = Machine(
        name="short_of_its_wall",
        states=("x", "v"),
        parameters={
            "forcing": FORCING, "frequency": FREQUENCY, "damping": DAMPING, "gap": GAP, "restitution": 0.8,
        },
        phase_rate="frequency",
        motion=motion,
        contacts=[
            Wall("R", gap=lambda state, phase, p: p.gap - state.x, push={"v": -1.0}, restitution="restitution")
        ],
    )  # fmt: skip
    response = FORCING / (1.0 - FREQUENCY**2 + 2j * DAMPING * FREQUENCY)
    orbit = machine.orbit("", guess=[[0.0, response.real, (1j * FREQUENCY * response).real]])
    assert orbit.nodes[0, 1] == pytest.approx(response.real, abs=1e-12)
    kept = [margin.value for margin in orbit.margins if margin.kind == "wall"]
    assert min(kept) == pytest.approx(GAP - abs(response), abs=1e-10)
    assert GAP - response.real > min(kept) + 1e-3  # it is closer than at the ends of the flight


@pytest.mark.parametrize(("drift", "left"), [(0.0, 1.5), (1e-10, 1.5), (1e-6, -1e-6), (-0.2, -0.2)])
def test_a_motion_that_comes_back_shifted_is_no_orbit(drift, left):
    """Its duration, 3 of the clock at 2 a unit of time, is no margin; the shift is, and negative."""
    data = SimpleNamespace(
        size=2, length=1, contacts=0, pinned=[0], guard_groups=[],
        clocks=lambda nodes: (np.array([1.0]), np.array([4.0])), clock_rate=lambda numbers: 2.0,
    )  # fmt: skip
    row = np.empty(2)
    fill_margins(data, np.zeros(3), SimpleNamespace(numbers=None, drift=[drift]), row)
    assert row[1] == pytest.approx(left, abs=1e-15) and row[0] == np.inf
