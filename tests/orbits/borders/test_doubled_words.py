"""What happens at a border once in a period, in every other period, or together with something else."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.attractors import find_attractor


def switches(graph, point):
    return [switch for switch in graph.switches if switch.point == point.label]


def at(graph, value, kind=None):
    """The real special point nearest to a parameter value."""
    points = [p for p in graph.special.values() if p.real and (kind is None or p.kind == kind)]
    return min(points, key=lambda p: abs(p.value - value))


def test_no_doubled_orbit_where_the_other_round_cannot_be():
    """`RLRsL` solves the maps at the border, but its first round would reverse: it is nowhere real."""
    machine = Absorber(
        restitution=0.7681303100552106,
        friction=0.8449920033953432,
        gravity=0.3468595434873274,
        mass_ratio=0.006,
        frequency=0.9686114331813895,
    )
    graph = cv.diagram(
        machine.orbit("RL", amplitude=0.8232), over="amplitude", within=(0.576242, 1.15248), depth=2
    )
    assert all(np.ptp(branch.values) > 1e-3 for branch in graph)
    graze = at(graph, 1.0055957, "velocity-graze")
    assert len(switches(graph, graze)) == 1
    for amplitude in (graze.value - 1e-4, graze.value + 1e-4):
        assert find_attractor(machine, {"w_rate": 1.0}, amplitude=amplitude, transient=2000).periods == 1


@pytest.mark.parametrize("length", [1.0, 10.0, 300.0, 1.0 / 300.0])
def test_a_stick_that_vanishes_in_every_other_round_whatever_the_unit(length):
    """Beside the border of `LsR` lie `LR` and, stable, `LsRLR`, on which the simulator settles; in every unit of length."""
    machine = Cavity(
        restitution_left=0.187988511664,
        restitution_right=0.146949315394,
        friction_left=0.486875724634,
        friction_right=0.227771540815,
        gravity=0.350912725868 * length,
        slope=-0.436876915907,
        distance_left=0.718238770362 * length,
        distance_right=1.287009084052 * length,
    )
    found = find_attractor(machine, {"w_rate": length}, amplitude=0.88 * length)
    assert sorted(found.text) == sorted("LsR")
    graph = cv.diagram(found.orbit, over="amplitude", within=(0.86 * length, 0.88 * length), depth=1)
    border = at(graph, 0.8694124 * length, "stick")
    targets = [graph[s.target] for s in switches(graph, border)]
    words = {"".join(sorted(b.description["word"])): b for b in targets}
    assert set(words) == {"LR", "LLRRs"} and not words["LR"].stable.any() and words["LLRRs"].stable.all()
    seen = find_attractor(machine, {"w_rate": length}, amplitude=0.868 * length, transient=2000)
    assert seen.periods == 2 and sorted(seen.text) == sorted("LsRLR")


def test_a_border_does_not_depend_on_the_steps():
    """A doubled orbit whose stick vanishes while its other round grazes: beyond it the simple orbit, followed in all cases."""
    machine = Cavity(
        restitution_left=0.74278442138,
        restitution_right=0.79636308072,
        friction_left=0.94439458090,
        friction_right=0.71229734608,
        gravity=0.65317808993,
        slope=0.09257194695,
        distance_left=0.75611650756,
        distance_right=1.19122723091,
    )
    orbit = machine.orbit("LRLR", periods=2, amplitude=1.14)
    borders = []
    for settings in ({}, {"max_step": 0.003, "angle": 0.01}, {"max_step": 0.1, "angle": 0.2}):
        graph = cv.diagram(orbit, over="amplitude", within=(0.9, 1.35), depth=0, settings=settings)
        assert {"".join(sorted(b.description["word"])) for b in graph} == {"LR", "LLRR", "LLRRs", "LRs"}
        borders.append([(p.kind, p.value) for p in graph.special.values()])
    for other in borders[1:]:
        for one in (borders[0], other):
            one.sort()
        assert [kind for kind, _ in other] == [kind for kind, _ in borders[0]]
        np.testing.assert_allclose(
            [value for _, value in other], [value for _, value in borders[0]], rtol=0, atol=1e-10
        )


def started(orbit):
    """A start of the simulator right beside an orbit's first impact."""
    start = {"phase": orbit.events.phase[0] % (2 * np.pi), "w": orbit.events.w[0]}
    return {**start, "w_rate": orbit.events.rate_post[0] * (1.0 + 1e-8)}


def test_periods_are_added_where_a_turn_touches_a_wall():
    """Beside the doubling, orbits of five, six and seven rounds with one more impact, on which the simulator settles.

    At the graze itself their multiplier is infinite, like the inverse of the square root of the distance: they are stable from a
    period doubling very close to it on. There the differenced simulation, which knows no branch, has a multiplier of -1.
    """
    machine = Absorber(
        restitution=0.15840379606858848,
        friction=0.27062304650022073,
        gravity=0.08085179925290478,
        mass_ratio=0.006,
    )
    graph = cv.diagram(machine.orbit("LttRtt", amplitude=1.28), over="amplitude", within=(1.27, 1.3), depth=1)
    graze = at(graph, 1.28857446, "wall-graze")
    added = [graph[s.target] for s in switches(graph, graze) if "times as long" in s.note]
    assert {branch.description["periods"] for branch in added} == {5, 6, 7}
    for branch in added:
        flips = [(i, graph[k]) for i, k in branch.marks if graph[k].kind == "period-doubling"]
        place, flip = flips[0]
        until = (
            flips[1][0] if len(flips) > 1 else len(branch.values)
        )  # that of five rounds loses its stability again
        assert not branch.stable[:place].any() and branch.stable[place + 1 : until].all()
        orbit = branch.orbit(place + 1)
        seen = find_attractor(machine, started(orbit), amplitude=orbit.parameters["amplitude"], max_period=8)
        assert (seen.periods, seen.impacts) == (orbit.periods, 2 * orbit.periods + 1)
        told = np.abs(seen.multipliers).max()
        assert told == pytest.approx(np.abs(orbit.multipliers).max(), abs=1e-3) and told < 1.0
        assert flip.multipliers.real.min() == pytest.approx(-1.0, abs=1e-9)
