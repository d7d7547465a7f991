"""Stick-slip beside a wall only just reaches it: what is left of the impacts is rounding, and the motion is that without them."""

import numpy as np
import pytest
from scipy.optimize import brentq

from orbits import Absorber
from orbits.attractors import find_attractor
from orbits.simulation import replay, simulate

# the start is stick-slip whose leftmost turn would be beyond the wall w = -1
PUSHED = [(0.3015185181471798, 0.6021440293850326, 0.8553118915161435, 0.6886562448753141)]


def slide(amplitude, pull):
    """Length of a slip of w'' = -C sin Psi - s a from rest where C |sin Psi| = a, in the phase."""
    first = np.arcsin(pull / amplitude)

    def speed(psi):
        return amplitude * (np.cos(first) - np.cos(psi)) - pull * (psi - first)

    last = brentq(speed, np.pi - first, first + 2.0 * np.pi, xtol=1e-14)
    return (
        amplitude * (np.sin(last) - np.sin(first))
        - amplitude * np.cos(first) * (last - first)
        + 0.5 * pull * (last - first) ** 2
    )


@pytest.mark.parametrize(("restitution", "friction", "gravity", "amplitude"), PUSHED)
@pytest.mark.parametrize("speed", [-1.6614814032848546, -1.2, 1.4])
def test_a_wall_that_is_only_just_reached_is_not_in_the_word(
    restitution, friction, gravity, amplitude, speed
):
    machine = Absorber(restitution=restitution, friction=friction, gravity=gravity)
    start = {"phase": 4.2572607284626764, "w": 0.22049651057690167, "w_rate": speed}
    found = find_attractor(machine, start, amplitude=amplitude)
    assert found.kind == "sliding" and sorted(found.letters) == list("ssuu") and found.impacts == 0
    w = np.unique(np.round(found.nodes[:, 1], 12))
    assert w[-1] - w[0] == pytest.approx(abs(slide(amplitude, friction * gravity)), abs=1e-12)
    # a slip starts where friction gives way, whatever the motion was before, and the position is free
    simulated = replay(found.orbit, thorough=True).multipliers
    assert np.sort(np.abs(simulated)) == pytest.approx([0.0, 1.0], abs=1e-6)
    # the simulation itself: once settled it stays between walls, and touches one with rounding's speed at most
    run = simulate(machine, found.state, periods=50, amplitude=amplitude)
    assert np.abs(run.rows[run.codes < 2, 3]).max(initial=0.0) < 1e-7
