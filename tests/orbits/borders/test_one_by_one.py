"""Borders one by one: what the diagram says at a border, the simulator must do beside it."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.attractors import find_attractor
from tests.machines import ABSORBER


def switches(graph, point):
    return [switch for switch in graph.switches if switch.point == point.label]


def at(graph, value, kind=None):
    """The real special point nearest to a parameter value."""
    points = [p for p in graph.special.values() if p.real and (kind is None or p.kind == kind)]
    return min(points, key=lambda p: abs(p.value - value))


@pytest.fixture(scope="module")
def pitchfork():
    """A machine whose asymmetric orbits come from the smooth pitchfork and go back at a border."""
    machine = Absorber(restitution=0.4040, friction=0.5859, gravity=0.4207)
    found = find_attractor(machine, {"w_rate": 1.0}, amplitude=1.4)
    return machine, cv.diagram(found.orbit, over="amplitude", within=(0.8, 2.0), depth=2)


def test_symmetry_breaks_at_a_border(pitchfork):
    """Symmetric `LR` and `LsRs` and asymmetric `LRs` meet in one velocity graze; only the asymmetric one is stable below."""
    machine, graph = pitchfork
    closing = next(
        p for p in graph.special.values()
        if p.kind in ("stick", "velocity-graze") and len(switches(graph, p)) >= 2
    )  # fmt: skip
    met = {graph[closing.branch].description["word"]} | {
        graph[s.target].description["word"] for s in switches(graph, closing)
    }
    assert {"".join(sorted(word)) for word in met} == {"LR", "LRs", "LRss"}
    below = find_attractor(machine, {"w_rate": 1.0}, amplitude=closing.value - 2e-3, transient=3000)
    above = find_attractor(machine, {"w_rate": 1.0}, amplitude=closing.value + 2e-3, transient=3000)
    assert not below.symmetric
    assert above.symmetric
    assert sorted(below.text) == sorted("LRs")
    assert sorted(above.text) == sorted("LsRs")
    # no branch twice, and the symmetric orbits are followed as such
    descriptions = [
        (b.description["word"], b.description["symmetric"], b.range) for b in graph.branches.values()
    ]
    assert len(set(descriptions)) == len(descriptions)
    assert any(word == "LR" and symmetric for word, symmetric, _ in descriptions)


def test_the_same_border_from_the_symmetric_side(pitchfork):
    """Started on the symmetric orbits, the diagram finds the asymmetric ones at the border as well."""
    machine, graph = pitchfork
    closing = next(
        p for p in graph.special.values() if len(switches(graph, p)) >= 2 and p.kind != "symmetry-breaking"
    )
    other = cv.diagram(machine.symmetric_orbit(amplitude=0.85), over="amplitude", within=(0.8, 2.0), depth=1)
    graze = at(other, closing.value, "velocity-graze")
    assert graze.value == pytest.approx(closing.value, abs=1e-10)
    words = sorted("".join(sorted(other[s.target].description["word"])) for s in switches(other, graze))
    assert words == ["LRs", "LRss"]


def test_persistence_is_told_from_a_fold():
    """The note of each crossing agrees with the ranges of the two branches."""
    graph = cv.diagram(
        ABSORBER.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.17, 1.27), depth=3
    )
    checked = 0
    for switch in graph.switches:
        point = graph.special[switch.point]
        if not ("persistence" in switch.note or "nonsmooth fold" in switch.note):
            continue
        source, target = graph[switch.source], graph[switch.target]
        sides = []
        for branch in (source, target):
            end = int(np.argmin(np.abs(branch.values - point.value) + 1e3 * ~_ends(branch, point.value)))
            inner = branch.values[1] if end == 0 else branch.values[-2]
            sides.append(np.sign(inner - point.value))
        checked += 1
        assert (sides[0] != sides[1]) == ("persistence" in switch.note), switch
    assert checked >= 6


def _ends(branch, value):
    ends = np.zeros(len(branch), bool)
    ends[[0, -1]] = np.abs(branch.values[[0, -1]] - value) < 1e-7
    return ends


def test_without_friction_flights_graze_the_walls():
    """mu = 0: `LR` loses an impact or gains one where a flight or an impact grazes a wall; the simulator agrees."""
    machine = Absorber(restitution=0.8077, friction=0.0, gravity=0.3)
    graph = cv.diagram(machine.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.05, 2.4), depth=2)
    kinds = [p.kind for p in graph.special.values()]
    assert "symmetry-breaking" in kinds
    assert "wall-graze" in kinds
    assert not {"velocity-graze", "stick"} & set(kinds)
    for point in graph.special.values():
        assert point.replay < 1e-5
    words = {b.description["word"] for b in graph.branches.values()}
    assert any("LL" in w + w or "RR" in w + w for w in words)
    for branch in graph.branches.values():
        inner = np.flatnonzero(branch.stable[1:-1]) + 1
        for i in inner[:: max(1, len(inner) // 3)]:
            orbit = branch.orbit(int(i))
            if orbit.margin < 1e-2 or np.abs(orbit.multipliers).max() > 0.98:
                continue
            start = {
                "phase": orbit.events.phase[0] % (2 * np.pi),
                "w": np.clip(orbit.events.w[0], -1, 1),
                "w_rate": orbit.events.rate_post[0] * (1 + 1e-7),
            }
            seen = find_attractor(machine, start, amplitude=float(branch.values[i]), max_period=8)
            assert (seen.impacts, seen.periods) == (orbit.impacts, orbit.periods)
            assert seen.word.canonical() == orbit.word.canonical()


STIFF = Absorber(restitution=0.41, friction=0.68, gravity=0.44, mass_ratio=0.006)


@pytest.fixture(scope="module")
def stiff():
    """A machine whose asymmetric orbits stick for half a radian when the next turn appears."""
    return cv.diagram(STIFF.orbit("LR", amplitude=0.75), over="amplitude", within=(0.1, 1.8), depth=2)


def test_a_stick_that_still_lasts_does_not_disappear(stiff):
    """Between the two borders the simulator has `LtsR` and nothing else; the diagram goes through it from both sides."""
    for amplitude in (1.2, 1.35, 1.5):
        seen = find_attractor(STIFF, {"w_rate": 1.0}, amplitude=amplitude, transient=1000)
        assert seen.word.canonical().text == "LRts"
        branch = next(
            b for b in stiff if b.problem is not None and b.stable.any() and _passes(b, seen, amplitude)
        )
        assert branch.range == pytest.approx((1.17727, 1.52545), abs=1e-4)
    assert not [s for s in stiff.switches if "stick disappears" in s.note]


def _passes(branch, seen, amplitude):
    low, high = branch.range
    if not low < amplitude < high or branch.problem.word.canonical() != seen.word.canonical():
        return False
    nearest = branch.orbit(int(np.argmin(np.abs(branch.values - amplitude))))
    return abs(nearest.parameters["amplitude"] - amplitude) < 0.05
