"""Bodies that always stick, at any place of a band: each motion is followed where it lies, alone or beside a body that moves."""

import numpy as np
import pytest

import contvines as cv
from orbits import DryFriction, Machine
from orbits.symbols import cos
from tests.orbits.declared.oscillators import oscillator
from tools.pages.pages import page

FREQUENCY, DRAG, GRIP = 1.3, 0.3, 1.5

PAIR = Machine(
    name="pair",
    states=("x", "y", "v", "w"),
    parameters={"forcing": 0.3, "frequency": FREQUENCY, "grip": GRIP},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (
        s.v,
        s.w,
        s.y - 2 * s.x + contact.grip,
        p.forcing * cos(phase) + s.x - 2 * s.y - DRAG * s.w,
    ),
    contacts=[DryFriction("grip", lambda s, phase, p: s.v, "grip")],
)


@pytest.mark.parametrize("place", [0.0, 0.2, -0.3])
def test_a_body_is_followed_where_it_lies_beside_one_that_moves(place: float) -> None:
    """y = x/2 + A cos(phase + angle) pulls at it with y - 2 x: it slips where A + 3/2 |x| is what friction holds."""
    rest = PAIR.attractor({"x": place}).orbit
    graph = cv.diagram(rest, over="forcing", within=(0.1, 1.0), depth=0)
    branch, slips = graph["B1"], graph["ST1"]
    response = 1.0 / np.hypot(2.0 - FREQUENCY**2, DRAG * FREQUENCY)
    assert slips.value == pytest.approx((GRIP - 1.5 * abs(place)) / response, rel=1e-12)
    assert np.abs(branch.points[:, 1] - place).max() < 1e-12
    assert branch.stable.all()
    assert (len(graph.branches) > 1) == (
        place == 0.0
    )  # elsewhere it slips one way only, and does not come back
    poles = np.exp(2.0 * np.pi / FREQUENCY * np.roots([1.0, DRAG, 2.0]))
    np.testing.assert_allclose(np.sort_complex(rest.multipliers), np.sort_complex(poles), atol=1e-10)


@pytest.mark.parametrize("place", [0.0, 0.1])
def test_a_body_alone_is_followed_where_it_lies(place: float) -> None:
    """The spring takes `place` of the friction; it slips where the forcing takes the rest."""
    rest = page("den_hartog").attractor({"x": place}, forcing=0.1).orbit
    graph = cv.diagram(rest, over="forcing", within=(0.02, 0.6), depth=0)
    assert graph["ST1"].branch == "B1"
    assert abs(graph["ST1"].value - (0.3 - place)) < 1e-9
    assert graph["B1"].stable.all()
    assert (len(graph.branches) > 1) == (place == 0.0)


@pytest.mark.parametrize("push", [0.0, 1e-10, 1e-6, -0.2])
def test_a_motion_that_comes_back_shifted_is_no_orbit(push: float) -> None:
    """A body that nothing holds moves on by 2 push in a unit of time."""
    free = oscillator(
        lambda s, phase, p, contact: cos(phase) - 0.5 * s.v + p.push,
        parameters={"frequency": FREQUENCY, "push": 0.0},
    )
    still = free.orbit("")
    problem = still.problem("push")
    shifted = problem.orbit(still.seed(problem)[0] + [0.0, 0.0, 2.0 * push], push)
    period = 2.0 * np.pi / FREQUENCY
    left = period if abs(push) < 1e-9 else -2.0 * abs(push) * period
    assert shifted.residual < 1e-11 and shifted.margin == pytest.approx(left, rel=1e-7)
