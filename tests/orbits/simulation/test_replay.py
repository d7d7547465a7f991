"""Replay of true and of false claims."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from orbits.attractors import find_attractor
from orbits.cycle import Cycle
from orbits.machines.absorber import Absorber
from orbits.simulation import replay
from orbits.words import Word

R, A = 0.76, 1.006 * 0.5 * 0.211
MACHINE = Absorber(restitution=R, friction=0.5, gravity=0.211, mass_ratio=0.006)


def symmetric_nodes(c):
    """LR solved from its half flight, L to R in half a period, in bare sines."""

    def equations(x):
        psi, rate = x
        slope = rate - c * np.cos(psi)
        landing = 1 - 2 * c * np.sin(psi) + slope * np.pi + A * np.pi**2 / 2
        arrival = slope - c * np.cos(psi) + A * np.pi
        return landing + 1, -R * arrival + rate

    psi, rate = fsolve(equations, [np.pi + 0.6, -1.2], xtol=1e-13)
    plus = c * np.cos(psi) - rate
    return np.array([[psi, plus], [psi + np.pi, -plus]])


def test_an_unstable_orbit_is_tracked_as_long_as_it_can_be():
    c = np.sqrt(0.65)
    nodes = symmetric_nodes(c)
    params = MACHINE.vector({"amplitude": c})
    told = replay(Cycle(MACHINE, Word.parse("LR"), 1, nodes, params), thorough=True)
    assert told.error < 1e-12
    assert told.message == ""
    growth = np.abs(told.multipliers).max()
    assert growth > 1.05
    assert np.prod(told.multipliers).real == pytest.approx(R**4, rel=1e-6)
    assert told.returned is None
    assert told.tracked >= 0.8 * min(told.expected, 200)


def test_a_stable_orbit_is_found_again():
    for c2 in (0.3, 0.6, 0.75, 0.9, 1.14, 1.7):
        found = find_attractor(MACHINE, {"w_rate": 1.0}, amplitude=np.sqrt(c2))
        told = replay(found, thorough=True)
        assert told.error < 1e-12
        assert told.returned is True
        assert told.tracked == 200


def test_a_wrong_event_list_is_refused():
    found = find_attractor(MACHINE, {"w_rate": 1.0}, amplitude=np.sqrt(0.9))
    assert sorted(found.text) == sorted("LRtt")
    impacts = found.word.codes < 2
    told = replay(Cycle(MACHINE, Word.parse("LR"), 1, found.nodes[impacts], found.params))
    assert told.error == np.inf
    assert not told.matches
    assert "is t, listed was" in told.message
    assert told.motion < 1e-12  # the same motion, told with other events


@pytest.mark.parametrize("c2", [0.012, 0.03, 0.1, 0.5, 0.74, 0.75, 0.9])
def test_every_event_can_be_the_first(c2):
    found = find_attractor(MACHINE, {"w_rate": 1.0}, amplitude=np.sqrt(c2))
    for k in range(len(found.word)):
        told = replay(found.found.rotate(k))
        assert told.error < 1e-11, (k, told.message)


def test_an_ill_conditioned_orbit_attracts_although_it_is_known_less_well_than_starts_come_back():
    """Nodes that are off by 1e-7, as those of a steep orbit are by rounding: starts come to the orbit itself; off by 1e-5 they are no orbit's."""
    found = find_attractor(MACHINE, {"w_rate": 1.0}, amplitude=np.sqrt(0.9))
    for off, back in ((1e-7, True), (1e-5, False)):
        told = replay(replace(found.found, nodes=found.nodes + [0.0, off]), thorough=True)
        assert told.returned is back
