"""What happens where a slow motion comes to rest in a sloping cavity: the push back has to beat the friction of the other way."""

import math

import pytest

from orbits import Cavity
from orbits.simulation import simulate

G, MU, SLOPE = 0.5, 0.5, 0.2
UP, DOWN = (G * (MU * math.cos(SLOPE) + way * math.sin(SLOPE)) for way in (1.0, -1.0))


@pytest.mark.parametrize(
    "way, push, code",
    [
        (
            -1.0,
            0.5 * (UP + DOWN),
            "s",
        ),  # downhill, pushed back uphill by less than the slope and friction ask for
        (-1.0, 1.2 * UP, "t"),
        (
            1.0,
            0.5 * (UP + DOWN),
            "t",
        ),  # uphill, pushed back downhill by more than friction less the slope asks for
        (1.0, 0.8 * DOWN, "s"),
    ],
)
def test_which_friction_decides_whether_the_motion_turns(way, push, code):
    """A positive slope pulls towards the right wall, w = -1; the cavity's push on the absorber is -C sin(phase)."""
    machine = Cavity(restitution=0.6, friction=MU, gravity=G, slope=SLOPE)
    start = {"w": 0.0, "w_rate": 1e-3 * way, "phase": way * math.asin(push / 0.9)}
    run = simulate(machine, start, events=1, periods=1, amplitude=0.9)
    assert run.letters == code
