"""Machines in whose diagrams the search once found something false: nothing of the kind is found in them now."""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from orbits.attractors import find_attractor
from orbits.simulation import replay
from tools.fuzz import neighbours, structure
from tools.fuzz.approached import comes_to
from tools.fuzz.between import Between
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact, rounds_apart
from tools.fuzz.motion import apart
from tools.fuzz.searching import LIMITS, search
from tools.fuzz.tally import Tally

pytestmark = pytest.mark.slow

SALT = 404
CHECKS = {"link", "jump", "doubled", "repeated", "limit", "stability", "margin", "no reason"}
FOUND = [
    ("cavity", 59),  # a border beside which another one is nearer than simulation began
    ("coupled", 177),  # the same
    ("cavity", 388),  # an orbit of a branch that only passes by a border
    ("cavity", 178),  # the same; and a branch that is real only close to the period doubling that it leaves
    ("cavity", 479),  # two borders of different motions, 4e-10 apart
    ("cavity", 99),  # branches that share the motion of a border
    ("coupled", 371),  # a branch of length 1e-11 that leaves a border by a doubling
    ("cavity", 206),  # multipliers that grow until the border is as near as 1e-9
    ("absorber", 339),  # a cascade stepped over: a branch point where nothing is singular
    ("cavity", 137),  # the same: the first point of a doubled branch on another one, which turns 1e-8 away
    ("absorber", 41),  # the same: a branch that comes back to others where it does not meet them
    ("coupled", 64),  # a fold just before a border
]
LATER = [
    (
        "level",
        2127,
        127,
    ),  # a branch 5e-8 beside the end of another one, with the same word, taken for that one
    ("level", 4411, 109),  # the first point of a branch beyond a border, behind the end of the interval
    ("level", 4411, 25),  # stable motions over 1e-8 of the parameter, between a doubling and a border
    (
        "cavity",
        4411,
        148,
    ),  # doublings 2.4e-13 apart, between which a last bit of the amplitude moves a multiplier
    (
        "coupled",
        4411,
        255,
    ),  # a margin that is zero to rounding all along hid where a virtual branch is real again
    ("coupled", 9401, 139),  # a slip of no length at the limit of rest: minus half of the digits
    ("cavity", 291129, 60),  # a fold 1e-11 before a doubling, past which a speed was measured
]


def diagram(kind, seed, salt=SALT, **options):
    drawn = draw(kind, salt, seed)
    return cv.diagram(drawn.orbit, **{**drawn.options, **options}, settings=LIMITS)


@pytest.mark.parametrize(("kind", "seed"), FOUND)
def test_nothing_is_found_any_more(kind, seed):
    graph, tally = diagram(kind, seed), Tally(kind, SALT, seed)
    structure.judge(graph, tally)
    neighbours.judge(graph, tally)
    assert not [finding for finding in tally.findings if finding.check in CHECKS]
    assert tally.counts["branches"] > 10


@pytest.mark.parametrize(("kind", "salt", "seed"), LATER)
def test_simulation_agrees(kind, salt, seed):
    assert search(kind, salt, seed).findings == []


def test_a_branch_comes_home_at_a_period_doubling():
    """One branch of twice the period for each. Its word repeats a shorter one, whose motion there has the multiplier -1: in eighty digits, from equations written anew."""
    graph = diagram("absorber", 41)
    ends = {
        (label, branch.label): branch.orbit(i)
        for branch in graph
        for i, label in branch.marks
        if branch.real
        and i in (0, len(branch) - 1)
        and label.startswith("PD")
        and graph[label].branch != branch.label
    }
    assert ends and len(ends) == len({label for label, _ in ends})
    for orbit in ends.values():
        root = orbit.root()
        assert 2 * root.periods == orbit.periods
        there = exact(root)
        assert abs(there.shift) < 1e-9
        assert np.abs(there.multipliers + 1.0).min() < 1e-3


def simulated_at(graph, branch, value):
    """The simulation follows a branch at this value if it is real, and only then."""
    between = Between(branch, graph.within)
    for i in np.flatnonzero((branch.values[:-1] - value) * (branch.values[1:] - value) < 0.0):
        share = (value - branch.values[i]) / (branch.values[i + 1] - branch.values[i])
        seen = replay(between.orbit(int(i), float(share)))
        assert (seen.matches and seen.error < 1e-8) == branch.real


@pytest.mark.parametrize(
    ("kind", "seed", "word", "value"),
    [("cavity", 97, "LRts", 1.020020423), ("coupled", 229, "LsRs", 0.947625)],
)
def test_a_virtual_branch_is_real_where_the_simulation_follows_it(kind, seed, word, value):
    """Between two points of it, margins that were lost are positive again and others are not yet lost."""
    graph = diagram(kind, seed, 408)
    there = [b for b in graph if b.description["word"] == word and b.range[0] < value < b.range[1]]
    followed = [b.label for b in there if b.real]
    assert len(followed) == 1
    for branch in there:
        simulated_at(graph, branch, value)


def test_right_beside_a_period_doubling_signs_are_not_those_of_rounding():
    """In eighty digits the doubled branch is stable from its first points on: nothing happens on it before its border."""
    graph = diagram("cavity", 259, 409)
    doubling = next(p for p in graph.of_kind("period-doubling") if abs(p.value - 0.379034268736721) < 1e-12)
    branch = next(b for b in graph if b.seed == doubling.label)
    assert [graph[label].kind for _, label in branch.marks] == ["period-doubling", "stick"]
    for i in range(1, len(branch) - 1):
        assert np.abs(exact(branch.orbit(i)).multipliers).max() < 1.0
        assert branch.stable[i]


def test_two_borders_that_differ_by_1e_12_are_two():
    """In eighty digits their values are as far apart as told, and their motions, of other words, too."""
    graph = diagram("cavity", 376, 409)
    borders = [p for p in graph.of_kind("wall-graze") if abs(p.value - 1.649868584062) < 2e-12]
    assert len(borders) == 2
    known = [exact(p.orbit) for p in borders]
    values = [p.value + found.shift for p, found in zip(borders, known)]
    assert all(abs(found.shift) < 1e-14 for found in known)
    assert abs(values[1] - values[0]) > 1e-12
    assert apart(borders[0].orbit, borders[1].orbit) > 1e-6
    joined = {frozenset((s.source, s.target)) for s in graph.switches}
    assert frozenset(p.branch for p in borders) not in joined


def test_a_slow_passage_beside_a_fold_is_no_attractor():
    """What it seems to repeat is, in eighty digits, the motion of a machine whose amplitude is 1e-8 larger: there the branch turns."""
    machine = draw("absorber", 414, 210).machine
    start = {"phase": 0.3196701108947567, "w": 0.07180270629232677, "w_rate": 1.231050380579057}
    found = find_attractor(machine, start, max_period=4, patience=1, amplitude=1.3923243664864222)
    assert found.kind == "chaotic" or abs(exact(found.orbit).shift) < 1e-10


def test_a_border_beyond_which_all_that_was_tried_came_to_nothing_says_why():
    """Two solutions beyond are proposed, and neither is real: a stick of 6.6e-4 with 6.4e-4 of friction in reserve vanishes as well."""
    graph = diagram("coupled", 178, 414)
    (border,) = (p for p in graph.of_kind("wall-graze") if p.branch == "B1")
    assert not any(switch.point == border.label for switch in graph.switches)
    assert "about to vanish" in border.note


def test_one_border_has_one_label():
    """LR grazes at both of its mirrored flights: a stick may begin at each (of positive or of negative duration), and four branches meet."""
    graph = diagram("coupled", 33, 415)
    borders = [p for p in graph.special.values() if p.kind in BORDERS and abs(p.value - 1.0001779826) < 1e-9]
    assert len(borders) == 1
    own = borders[0].orbit
    there = [b for b in graph if any(label == borders[0].label for _, label in b.marks)]
    for branch in there:
        for i, label in branch.marks:
            if (
                label == borders[0].label
            ):  # by their impacts: the time of a virtual motion may run backwards there; square roots
                orbit = branch.orbit(i)
                hits = [k for k, event in enumerate(orbit.word.events) if event in "LR"]
                np.testing.assert_allclose(orbit.nodes[hits], own.nodes, atol=1e-5)
    # where both sticks vanish a motion with unlike ones becomes symmetric, too: its last bits decide which of the two is the label
    ends = [
        (b, i)
        for b in graph
        for i, label in b.marks
        if b.description["word"] == "LsRs" and abs(graph.special[label].value - borders[0].value) < 1e-13
    ]
    assert {b.real for b, _ in ends} == {True, False}
    durations = [b.orbit(1 if i == 0 else i - 1).durations[[1, 4]] for b, i in ends]
    signs = {tuple(np.sort(np.sign(pair))) for pair in durations}
    assert signs == {(1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)}


def test_beyond_a_border_a_doubled_solution_is_not_taken_for_the_shorter_one_it_leaves():
    """8e-8 beyond its period doubling the doubled branch ends at a border: that joins branches of its own motion only."""
    graph = diagram("absorber", 54, 416)
    border = next(p for p in graph.of_kind("wall-graze") if abs(p.value - 2.0808763475280) < 1e-11)
    joined = {end for s in graph.switches if s.point == border.label for end in (s.source, s.target)}
    assert len(joined) == 2
    for label in joined:
        assert min(apart(border.orbit, graph[label].orbit(i)) for i in (0, -1)) < 1e-9
    doubled = exact(border.orbit)
    assert abs(doubled.shift) < 1e-12
    assert rounds_apart(border.orbit, 1) > 1e-7


def test_a_steep_branch_comes_to_its_period_doubling_in_many_digits():
    """In doubles what is solved for 3e-8 beside it lies on the shorter orbits, whose motion changes 2e5 times as fast as the amplitude."""
    graph = diagram("absorber", 169, 416)
    point = next(p for p in graph.of_kind("period-doubling") if abs(p.value - 1.0673625373057962) < 1e-13)
    branch = next(b for b in graph if b.seed == point.label)
    tally = Tally("absorber", 416, 169)
    neighbours.judge(replace(graph, branches={branch.label: branch}, switches=[]), tally)
    assert not tally.findings
    assert comes_to(branch.orbit(2), branch.orbit(1), branch.orbit(0))


@pytest.mark.parametrize(("seed", "label"), [(1, "B17"), (9, "B30"), (33, "B15")])
def test_multipliers_beside_an_infinite_one_are_no_evidence(seed, label):
    """Where a branch begins at a graze one multiplier is infinite, and rounding of it moves the others over the circle: nothing happens there."""
    graph = diagram("coupled", seed, 4817)
    assert not graph.unresolved
    branch = graph[label]
    first = branch.marks[0]
    assert first[0] == 0 and graph[first[1]].kind == "wall-graze"
    assert len({int((np.abs(m) > 1.0).sum()) for m in branch.multipliers[1:5]}) == 1


def test_a_doubling_right_behind_where_a_pair_splits():
    """Outside the circle a pair becomes two real multipliers, one of which enters 2e-10 (frequency) later: at -1 in eighty digits."""
    graph = diagram("coupled", 45, 4817)
    point = min(graph.of_kind("period-doubling"), key=lambda p: abs(p.value - 1.03026475831))
    found = exact(point.orbit)
    assert abs(found.shift) < 1e-14
    assert np.abs(found.multipliers + 1.0).min() < 1e-6


@pytest.mark.parametrize("fold", [1.33963555623378, 1.33963554542592])
def test_a_doubling_within_rounding_of_a_fold_is_said_to_be_unresolved(fold):
    """The multiplier that is 1 at the fold goes on through infinity and comes back through -1, 1e-14 and 3e-13 (amplitude) behind it: before and
    behind it is inside the circle, which a fold alone does not leave so."""
    graph = diagram("absorber", 59, 9117)
    point = min(graph.of_kind("fold"), key=lambda p: abs(p.value - fold))
    index = next(i for i, label in graph[point.branch].marks if label == point.label)
    before, behind = (np.abs(graph[point.branch].multipliers[i]).max() for i in (index - 1, index + 3))
    assert before < 1.0 and behind < 1.0 and abs(point.multipliers[0] - 1.0) < 1e-6
    doublings = [p.value for p in graph.of_kind("period-doubling") if p.branch == point.branch]
    told = [0.5 * (u.low + u.high) for u in graph.unresolved if u.branch == point.branch]
    assert min(abs(x - fold) for x in doublings + told) < 1e-10


@pytest.mark.parametrize(("kind", "seed"), [("absorber", 2), ("level", 13)])
def test_a_sign_of_rounding_beside_where_a_branch_begins_is_nothing_unresolved(kind, seed):
    """A virtual stick-slip motion, all of whose multipliers are zero, begins at a stick: the parameter is stationary there to rounding."""
    assert not diagram(kind, seed, 60611).unresolved
