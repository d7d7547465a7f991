"""Multipliers at borders are the limits of those of the orbits beside them, as the simulation has them on each side."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.locate import Segment
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings
from orbits import Absorber, Cavity, Coupled
from orbits.flows import simulator_of
from orbits.simulation.replaying import monodromy
from orbits.starts.find import polish
from tests.machines import ABSORBER, absorber_graph

pytestmark = pytest.mark.slow

FIRST = 1.5e-2  # farthest orbit: speed of the impact, or duration of the stick, that vanishes


STARTS = {
    "reduced": (
        Absorber(restitution=0.88432, friction=0.91958, gravity=0.576347, mass_ratio=0.05),
        {"w_rate": 1.0, "phase": 2.439}, "amplitude", 1.96332, (1.95, 2.05),
    ),
    "tilted": (
        Cavity(
            restitution_left=0.42777, restitution_right=0.51675, friction_left=0.926035, friction_right=0.820553,
            gravity=0.577311, slope=0.311532, distance_left=0.642074, distance_right=0.682441, mass_ratio=0.05,
        ),
        {"w_rate": 1.0, "phase": 2.4623}, "amplitude", 1.58765, (1.24, 1.6),
    ),
    "coupled": (
        Coupled(
            restitution=0.71165, friction=0.75434, gravity=0.839185, mass_ratio=0.3, damping=0.985537, forcing=2.54884
        ),
        {"w": 0.5, "v": 1.0}, "frequency", 0.8785388, (0.77, 0.9),
    ),
}  # fmt: skip


def vanishing(orbit):
    """What grows from nothing: the speeds of impacts and the durations of sticks and flights next to them."""
    return min(abs(margin.value) for margin in orbit.margins if margin.kind in ("approach", "duration"))


def simulated(orbit):
    """Characteristic polynomial of the simulation's return map, started at the hardest impact, or at a stick."""
    hard = max((m for m in orbit.margins if m.kind == "approach"), key=lambda m: m.value)
    place = hard.segment if hard.value > 0.05 else orbit.word.events.index("s")
    start = orbit.rotate(place)
    word = start.word
    matrix = monodromy(simulator_of(orbit.model, orbit.params), word, start.nodes[0])
    return None if matrix is None else np.poly(matrix).real


def seen_beside(branch, end):
    """Coefficients of the characteristic polynomial of the simulated return map, extrapolated to an end of a branch."""
    places = range(len(branch))[:: -1 if end else 1]
    inner = next(k for k in places if vanishing(branch.orbit(k)) > 2e-3)
    engine = Engine(branch.problem, branch.range, Settings())
    segment = Segment(
        engine,
        *(
            Solved(branch.points[k], branch.values[k], engine.unit(branch.tangents[k]) * (-1 if end else 1), np.zeros(0), 0.0, 0.0, 0.0)
            for k in (end, inner)
        ),
    )  # fmt: skip

    def beside(share):
        point = segment.at(share)
        return branch.problem.orbit(point.u, point.p)

    share = 1.0
    while vanishing(beside(share)) > FIRST:
        share *= 0.7
    orbits = [beside(share * part) for part in np.linspace(0.2, 1.0, 9)]
    pairs = [(vanishing(orbit), seen) for orbit in orbits if (seen := simulated(orbit)) is not None]
    assert len(pairs) >= 5
    sizes, coefficients = zip(*pairs)
    return np.polynomial.polynomial.polyfit(sizes, np.array(coefficients), 3)[0]


@pytest.mark.parametrize("name", STARTS)
def test_limits_at_borders(name):
    """An impact of vanishing speed that a stick follows at once makes the equations singular, but not the motion."""
    machine, start, over, value, within = STARTS[name]
    orbit = polish(machine.attractor(start, **{over: value}).orbit)
    graph = cv.diagram(orbit, over=over, within=within, depth=1)
    checked = 0
    for branch in graph:
        for end, label in branch.marks:
            point = graph[label]
            if (
                end not in (0, len(branch) - 1)
                or np.ptp(branch.values) < 1e-4
                or point.kind not in ("stick", "wall-graze", "velocity-graze")
            ):
                continue
            here = branch.orbit(end)
            soft = [m.segment for m in here.margins if m.kind == "approach" and abs(m.value) < 1e-9]
            if not any(here.word.events[(place + 1) % len(here.word)] == "s" for place in soft):
                continue
            expected, found = seen_beside(branch, end), branch.multipliers[end]
            assert np.poly(found) == pytest.approx(expected, abs=5e-3 * np.abs(expected).max())
            checked += 1
            listed = [point.multipliers, point.multipliers_beyond]
            assert any(np.array_equal(m, found) for m in listed if m is not None)
    assert checked


def test_at_a_graze_a_multiplier_is_infinite_and_the_other_one_is_none():
    """Towards a wall that is touched without speed that of half the motion grows as the speed's inverse; their product is bounded."""
    graph = absorber_graph(0.55, (0.2, 1.1), depth=0)
    end, value = graph["WG1"].orbit, graph["WG1"].value
    grown, gone = end.multipliers
    assert grown == complex(np.inf) and gone == pytest.approx(0.0, abs=1e-12)
    assert not end.stable
    beside = [ABSORBER.orbit("LR", 1, end.nodes, amplitude=value - off) for off in (1e-5, 1e-7)]
    sizes = [orbit.multipliers[0].real * orbit.margin**2 for orbit in beside]
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-2) and sizes[1] > 0.0
