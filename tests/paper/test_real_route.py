"""The real route of the paper's set, beside roots of a brute-force return map of 40 digits and orbits solved anew in eighty.

Machine: r = 0.76, mu = 0.5, g = 0.211, eps = 0.006, Omega = 1. The values of C^2 below are roots of the return map: the motion
integrated event by event, multipliers by central differences, and the parameter moved until the border's own condition holds.
"""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from tests.machines import absorber_graph
from tools.fuzz.many_digits import exact

pytestmark = pytest.mark.slow

# Kinds of the points that are met, C^2 there, and the word beyond
ROUTE = [
    ("symmetry-breaking", 0.5282903125517541, "LR"),  # symmetric LR, half map's multiplier -1
    ("velocity-graze", 0.7322667847680374, "LRs"),  # asymmetric LR, w' touches 0 in the long flight
    ("stick", 0.7489568973481195, "LRts"),  # the stick's reserve a - |v''| is used up: a turn comes before it
    ("stick", 0.7982897117006584, "LRtt"),  # the second zero of w' is a turn as well
    ("period-doubling", 1.1282649657742850, "LRttLRtt"),  # LRtt, multiplier -1
]


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.55, (0.17, 1.27), depth=3)


def route(graph):
    """Points met from the symmetry breaking to the period-4-impact orbits by the switches alone, and the branches behind them."""
    targets = {switch.point: graph[switch.target] for switch in reversed(graph.switches)}
    (point,) = graph.of_kind("symmetry-breaking")[:1]
    steps = [(point, targets[point.label])]
    while point.kind != "period-doubling":
        here, kinds = steps[-1][1].label, ("velocity-graze", "stick", "period-doubling")
        (point,) = (p for p in graph.special.values() if p.branch == here and p.kind in kinds)
        steps.append((point, targets[point.label]))
    return steps


def test_the_diagram_walks_the_real_route(graph):
    steps = route(graph)
    assert [branch.description["periods"] for _, branch in steps] == [1, 1, 1, 1, 2]
    assert steps[-1][1].description["impacts"] == 4
    for (point, branch), (kind, square, word) in zip(steps, ROUTE, strict=True):
        assert point.kind == kind and sorted(branch.description["word"]) == sorted(word)
        assert point.real and branch.real
        assert point.value**2 == pytest.approx(square, abs=1e-10)
        assert point.replay is not None and point.replay < 1e-9
        assert point.residual < 1e-12


def test_orbits_of_the_route_in_eighty_digits(graph):
    """Nodes and multipliers in the middle of each branch; where one leaves smoothly, a multiplier is 1 or -1."""
    for point, branch in route(graph):
        orbit = branch.orbit(len(branch) // 2)
        told = exact(orbit)
        assert told.moved < 1e-12
        assert np.poly(orbit.multipliers) == pytest.approx(np.poly(told.multipliers), abs=1e-10)
        if point.kind in ("symmetry-breaking", "period-doubling"):
            critical = 1.0 if point.kind == "symmetry-breaking" else -1.0
            there = exact(point.orbit)
            assert np.abs(there.multipliers - critical).min() < 1e-9 and abs(there.shift) < 1e-12


def test_multipliers_jump_at_the_graze(graph):
    """Both sides are kept: a stick forgets, so one multiplier is 0 beyond the velocity graze."""
    point = route(graph)[1][0]
    assert np.abs(point.multipliers).min() > 0.1
    assert np.abs(point.multipliers_beyond).min() < 1e-9


@pytest.mark.parametrize(
    ("friction", "gravity", "mass_ratio"),
    [(0.5, 0.211, 0.006), (0.1, 0.422, 0.006), (0.3, 0.355, 0.006), (0.8, 0.4, 0.05)],
)
def test_sliding_lives_between_its_bounds(friction, gravity, mass_ratio):
    """`tt` from C^2 = h^2 (1 + 4/pi^2), where its turns become sticks, to 1 + h^2, where it grazes the
    walls."""
    h = (1 + mass_ratio) * friction * gravity * np.pi / 2
    bounds = h**2 * (1 + 4 / np.pi**2), 1 + h**2
    absorber = Absorber(restitution=0.76, friction=friction, gravity=gravity, mass_ratio=mass_ratio)
    orbit = absorber.orbit("tt", amplitude=np.sqrt(sum(bounds) / 2))
    graph = cv.diagram(orbit, over="amplitude", within=(0.02, 1.6), depth=0)
    low, high = graph["B1"].range
    assert (low**2, high**2) == pytest.approx(bounds, abs=1e-10)
    ends = {p.kind: p for p in graph.special.values() if p.branch == "B1" and p.real}
    assert ends["stick"].value == pytest.approx(low, abs=1e-14)
    assert ends["wall-graze"].value == pytest.approx(high, abs=1e-14)
    # at the top the absorber turns exactly at the walls, at the bottom it sticks at each turn from there on
    assert np.abs(ends["wall-graze"].orbit.nodes[:, 1]) == pytest.approx(1.0, abs=1e-10)
    assert "s" in graph["B2"].description["word"]
    assert graph["B2"].range[1] == pytest.approx(low, abs=1e-12)
