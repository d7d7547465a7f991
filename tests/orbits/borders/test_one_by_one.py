"""Borders one by one: what the diagram says at a border, once in a period or in every other one, the simulator must do beside it."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.attractors import find_attractor
from tests.machines import absorber_graph


def targets(graph, point):
    """The branches that a special point leads to."""
    return [graph[switch.target] for switch in graph.switches if switch.point == point.label]


def words(branches):
    """Branches by the letters of their words, sorted."""
    return {"".join(sorted(branch.description["word"])): branch for branch in branches}


def at(graph, value, *kinds):
    """The real special point nearest to a parameter value."""
    points = [p for p in graph.special.values() if p.real and (not kinds or p.kind in kinds)]
    return min(points, key=lambda p: abs(p.value - value))


def settled_beside(orbit, **options):
    """What the simulator settles on that starts right beside an orbit's first impact."""
    events = orbit.events
    start = {"phase": events.phase[0] % (2 * np.pi), "w": np.clip(events.w[0], -1.0, 1.0)}
    start["w_rate"] = events.rate_post[0] * (1.0 + 1e-8)
    amplitude = orbit.parameters["amplitude"]
    return find_attractor(orbit.model, start, amplitude=amplitude, max_period=8, **options)


def test_symmetry_breaks_at_a_border():
    """Symmetric `LR` and `LsRs` and asymmetric `LRs` meet in one velocity graze; only the asymmetric one is stable below.

    The asymmetric orbits come from the smooth pitchfork. Started on the symmetric ones, the diagram finds them at the border as well.
    """
    machine = Absorber(restitution=0.4040, friction=0.5859, gravity=0.4207)
    found = machine.attractor({"w_rate": 1.0}, amplitude=1.4)
    graph = cv.diagram(found, over="amplitude", within=(0.8, 2.0), depth=2)
    closing = next(
        p for p in graph.special.values() if p.kind != "symmetry-breaking" and len(targets(graph, p)) >= 2
    )
    assert set(words([graph[closing.branch], *targets(graph, closing)])) == {"LR", "LRs", "LRss"}
    for off, symmetric, word in ((-2e-3, False, "LRs"), (2e-3, True, "LRss")):
        seen = find_attractor(machine, {"w_rate": 1.0}, amplitude=closing.value + off, transient=3000)
        assert (seen.symmetric, "".join(sorted(seen.text))) == (symmetric, word)
    # no branch twice, and the symmetric orbits are followed as such
    descriptions = [(b.description["word"], b.description["symmetric"], b.range) for b in graph]
    assert len(set(descriptions)) == len(descriptions)
    assert any(word == "LR" and symmetric for word, symmetric, _ in descriptions)
    other = cv.diagram(machine.symmetric_orbit(amplitude=0.85), over="amplitude", within=(0.8, 2.0), depth=1)
    graze = at(other, closing.value, "velocity-graze")
    assert graze.value == pytest.approx(closing.value, abs=1e-10)
    assert sorted(words(targets(other, graze))) == ["LRs", "LRss"]


def test_persistence_is_told_from_a_fold():
    """The note of each crossing agrees with the sides on which the two branches are; a lone branch is not told to end there."""
    graph = absorber_graph(0.55, (0.17, 1.27), depth=3)
    told = [s for s in graph.switches if "persistence" in s.note or "nonsmooth fold" in s.note]
    for switch in told:
        value = graph[switch.point].value
        above = []
        for branch in (graph[switch.source], graph[switch.target]):
            end = np.argmin(np.abs(branch.values[[0, -1]] - value))
            above.append(branch.values[[1, -2]][end] > value)
        assert (above[0] != above[1]) == ("persistence" in switch.note), switch
    assert len(told) >= 6
    lone = cv.diagram(
        graph["B3"].orbit(5), over="amplitude", within=(0.17, 1.27), settings={"max_branches": 1}
    )
    assert lone["VG1"].value == pytest.approx(graph["VG1"].value) and not lone["VG1"].remarks


def test_without_friction_flights_graze_the_walls():
    """mu = 0: `LR` loses an impact or gains one where a flight or an impact grazes a wall; the simulator agrees."""
    machine = Absorber(restitution=0.8077, friction=0.0, gravity=0.3)
    graph = cv.diagram(machine.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.05, 2.4), depth=2)
    kinds = {p.kind for p in graph.special.values()}
    assert {"symmetry-breaking", "wall-graze"} <= kinds and not {"velocity-graze", "stick"} & kinds
    assert all(point.replay < 1e-5 for point in graph.special.values())
    assert any("LL" in word * 2 or "RR" in word * 2 for word in (b.description["word"] for b in graph))
    for branch in graph:
        inner = np.flatnonzero(branch.stable[1:-1]) + 1
        for i in inner[:: max(1, len(inner) // 3)]:
            orbit = branch.orbit(int(i))
            if orbit.margin < 1e-2 or np.abs(orbit.multipliers).max() > 0.98:
                continue
            seen = settled_beside(orbit)
            assert (seen.impacts, seen.periods) == (orbit.impacts, orbit.periods)
            assert seen.word.canonical() == orbit.word.canonical()


def test_a_stick_that_still_lasts_does_not_disappear():
    """Asymmetric orbits stick for half a radian when the next turn appears.

    Between the two borders the simulator has `LtsR` and nothing else; the diagram goes through it from both sides.
    """
    machine = Absorber(restitution=0.41, friction=0.68, gravity=0.44, mass_ratio=0.006)
    graph = cv.diagram(machine.orbit("LR", amplitude=0.75), over="amplitude", within=(0.1, 1.8), depth=2)
    for amplitude in (1.2, 1.35, 1.5):
        seen = find_attractor(machine, {"w_rate": 1.0}, amplitude=amplitude, transient=1000)
        assert seen.word.canonical().text == "LRts"
        (branch,) = (
            b
            for b in graph
            if b.range[0] < amplitude < b.range[1]
            and b.stable.any()
            and b.problem.word.canonical() == seen.word.canonical()
        )
        assert branch.range == pytest.approx((1.17727, 1.52545), abs=1e-4)
    assert not [s for s in graph.switches if "stick disappears" in s.note]


# ------------------------------------------------------------------ in every other period, or together with something else
def test_no_doubled_orbit_where_the_other_round_cannot_be():
    """`RLRsL` solves the maps at the border, but its first round would reverse: it is nowhere real."""
    machine = Absorber(
        restitution=0.7681303100552106, friction=0.8449920033953432, gravity=0.3468595434873274,
        mass_ratio=0.006, frequency=0.9686114331813895,
    )  # fmt: skip
    start = machine.orbit("RL", amplitude=0.8232)
    graph = cv.diagram(start, over="amplitude", within=(0.576242, 1.15248), depth=2)
    assert all(np.ptp(branch.values) > 1e-3 for branch in graph)
    graze = at(graph, 1.0055957, "velocity-graze")
    assert len(targets(graph, graze)) == 1
    for amplitude in (graze.value - 1e-4, graze.value + 1e-4):
        assert find_attractor(machine, {"w_rate": 1.0}, amplitude=amplitude, transient=2000).periods == 1


@pytest.mark.parametrize("length", [1.0, 10.0, 300.0, 1.0 / 300.0])
def test_a_stick_that_vanishes_in_every_other_round_whatever_the_unit(length):
    """Beside the border of `LsR` lie `LR` and, stable, `LsRLR`, on which the simulator settles; in every unit of length."""
    machine = Cavity(
        restitution_left=0.187988511664, restitution_right=0.146949315394,
        friction_left=0.486875724634, friction_right=0.227771540815,
        gravity=0.350912725868 * length, slope=-0.436876915907,
        distance_left=0.718238770362 * length, distance_right=1.287009084052 * length,
    )  # fmt: skip
    found = find_attractor(machine, {"w_rate": length}, amplitude=0.88 * length)
    assert sorted(found.text) == sorted("LsR")
    graph = cv.diagram(found.orbit, over="amplitude", within=(0.86 * length, 0.88 * length), depth=1)
    met = words(targets(graph, at(graph, 0.8694124 * length, "stick")))
    assert set(met) == {"LR", "LLRRs"} and not met["LR"].stable.any() and met["LLRRs"].stable.all()
    seen = find_attractor(machine, {"w_rate": length}, amplitude=0.868 * length, transient=2000)
    assert seen.periods == 2 and sorted(seen.text) == sorted("LsRLR")


def test_a_border_does_not_depend_on_the_steps():
    """A doubled orbit whose stick vanishes while its other round grazes: beyond it the simple orbit, followed in all cases."""
    machine = Cavity(
        restitution_left=0.74278442138, restitution_right=0.79636308072,
        friction_left=0.94439458090, friction_right=0.71229734608, gravity=0.65317808993, slope=0.09257194695,
        distance_left=0.75611650756, distance_right=1.19122723091,
    )  # fmt: skip
    orbit = machine.orbit("LRLR", periods=2, amplitude=1.14)
    borders = []
    for settings in ({}, {"max_step": 0.003, "angle": 0.01}, {"max_step": 0.1, "angle": 0.2}):
        graph = cv.diagram(orbit, over="amplitude", within=(0.9, 1.35), depth=0, settings=settings)
        assert set(words(graph)) == {"LR", "LLRR", "LLRRs", "LRs"}
        borders.append(sorted((p.kind, p.value) for p in graph.special.values()))
    (kinds, values), *others = (tuple(zip(*found)) for found in borders)
    for found, places in others:
        assert found == kinds and places == pytest.approx(values, abs=1e-10)


def test_periods_are_added_where_a_turn_touches_a_wall():
    """Beside the doubling, orbits of five, six and seven rounds with one more impact, on which the simulator settles.

    At the graze itself their multiplier is infinite, like the inverse of the square root of the distance: they are stable from a
    period doubling very close to it on. There the differenced simulation, which knows no branch, has a multiplier of -1.
    """
    machine = Absorber(
        restitution=0.15840379606858848, friction=0.27062304650022073, gravity=0.08085179925290478,
        mass_ratio=0.006,
    )  # fmt: skip
    graph = cv.diagram(machine.orbit("LttRtt", amplitude=1.28), over="amplitude", within=(1.27, 1.3), depth=1)
    graze = at(graph, 1.28857446, "wall-graze")
    added = [graph[s.target] for s in graph.switches if s.point == graze.label and "times as long" in s.note]
    assert {branch.description["periods"] for branch in added} == {5, 6, 7}
    for branch in added:
        flips = [(i, graph[k]) for i, k in branch.marks if graph[k].kind == "period-doubling"]
        # that of five rounds loses its stability again
        (place, flip), (until, _), *_ = [*flips, (len(branch.values), None)]
        assert not branch.stable[:place].any() and branch.stable[place + 1 : until].all()
        orbit = branch.orbit(place + 1)
        seen = settled_beside(orbit)
        assert (seen.periods, seen.impacts) == (orbit.periods, 2 * orbit.periods + 1)
        told = np.abs(seen.multipliers).max()
        assert told == pytest.approx(np.abs(orbit.multipliers).max(), abs=1e-3) and told < 1.0
        assert flip.multipliers.real.min() == pytest.approx(-1.0, abs=1e-9)
