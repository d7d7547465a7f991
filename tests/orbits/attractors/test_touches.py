"""Stick-slip beside a wall only just reaches it: what is left of the impacts is rounding, and the motion is that without them."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.simulation import replay, simulate

# the start is stick-slip whose leftmost turn would be beyond the wall w = -1
MACHINE = Absorber(restitution=0.3015185181471798, friction=0.6021440293850326, gravity=0.8553118915161435)
AMPLITUDE = 0.6886562448753141


def slide():
    """Length of a slip of w'' = -C sin Psi - s a from rest where C |sin Psi| = a, in the phase."""
    pull = MACHINE.friction * MACHINE.gravity
    first = np.arcsin(pull / AMPLITUDE)

    def speed(psi):
        return AMPLITUDE * (np.cos(first) - np.cos(psi)) - pull * (psi - first)

    last = brentq(speed, np.pi - first, first + 2.0 * np.pi, xtol=1e-14)
    return quad(speed, first, last, epsabs=1e-14)[0]


@pytest.mark.parametrize("speed", [-1.6614814032848546, -1.2, 1.4])
def test_a_wall_that_is_only_just_reached_is_not_in_the_word(speed):
    start = {"phase": 4.2572607284626764, "w": 0.22049651057690167, "w_rate": speed}
    found = find_attractor(MACHINE, start, amplitude=AMPLITUDE)
    assert found.kind == "sliding" and sorted(found.letters) == list("ssuu") and found.impacts == 0
    assert np.ptp(found.nodes[:, 1]) == pytest.approx(slide(), abs=1e-12)
    # a slip starts where friction gives way, whatever the motion was before, and the position is free
    simulated = replay(found.orbit, thorough=True).multipliers
    assert np.sort(np.abs(simulated)) == pytest.approx([0.0, 1.0], abs=1e-6)
    # the simulation itself: once settled it stays between walls, and touches one with rounding's speed at most
    run = simulate(MACHINE, found.state, periods=50, amplitude=AMPLITUDE)
    assert run.approaches().max(initial=0.0) < 1e-7
