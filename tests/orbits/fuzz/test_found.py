"""Machines in whose diagrams the search once found something false: nothing of the kind is found in them now.

`search` judges a diagram by simulation, by orbits beside every point and, where doubles tell nothing, in eighty digits.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from orbits.attractors import find_attractor
from orbits.simulation import replay
from tools.fuzz import neighbours, structure
from tools.fuzz.between import Between
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact
from tools.fuzz.searching import LIMITS, search
from tools.fuzz.tally import Tally

pytestmark = pytest.mark.slow

FOUND = [
    ("cavity", 404, 59),  # a border beside which another one is nearer than simulation began
    ("coupled", 404, 177),  # the same
    ("cavity", 404, 388),  # an orbit of a branch that only passes by a border
    ("cavity", 404, 178),  # the same; and a branch real only close to the period doubling that it leaves
    ("cavity", 404, 479),  # two borders of different motions, 4e-10 apart
    ("cavity", 404, 99),  # branches that share the motion of a border
    ("coupled", 404, 371),  # a branch of length 1e-11 that leaves a border by a doubling
    ("cavity", 404, 206),  # multipliers that grow until the border is as near as 1e-9
    ("absorber", 404, 339),  # a cascade stepped over: a branch point where nothing is singular
    ("absorber", 404, 41),  # a branch that comes back to others where it does not meet them
    ("coupled", 404, 64),  # a fold just before a border
    ("cavity", 409, 259),  # right beside a period doubling, signs of rounding
    ("cavity", 409, 376),  # two borders of different motions, 1e-12 apart
    ("coupled", 414, 178),  # a border beyond which all that was tried came to nothing, without a reason
    ("absorber", 416, 54),  # beyond a border, a doubled solution taken for the shorter one, 8e-8 away
    ("absorber", 416, 169),  # a motion that changes 2e5 times as fast as the amplitude, beside a doubling
    ("cavity", 418, 184),  # a virtual branch that comes to its point by rounding only
    ("cavity", 419, 25),  # the same
    ("cavity", 418, 297),  # multipliers at grazes of branches 6e-12 and 1e-13 long
    ("cavity", 419, 165),  # four rounds, home to what seemed two and is one
    ("level", 2127, 127),  # a branch 5e-8 beside the end of another one with the same word
    ("level", 4411, 109),  # the first point of a branch beyond a border, behind the end of the interval
    ("level", 4411, 25),  # stable motions over 1e-8 of the parameter, between a doubling and a border
    ("cavity", 4411, 148),  # doublings 2.4e-13 apart, where a last bit of the amplitude moves a multiplier
    ("coupled", 4411, 255),  # a margin zero to rounding hid where a virtual branch is real again
    ("coupled", 9401, 139),  # a slip of no length at the limit of rest: minus half of the digits
    ("cavity", 291129, 60),  # a fold 1e-11 before a doubling, past which a speed was measured
]


@pytest.mark.parametrize(("kind", "salt", "seed"), FOUND)
def test_nothing_is_found_any_more(kind, salt, seed):
    tally = search(kind, salt, seed)
    assert tally.findings == [] and tally.counts["branches"]


def diagram(kind, salt, seed, **options):
    drawn = draw(kind, salt, seed)
    return cv.diagram(drawn.orbit, **{**drawn.options, **options}, settings=LIMITS)


def findings(graph):
    """What is found in the graph and beside its points."""
    tally = Tally()
    structure.judge(graph, tally)
    neighbours.judge(graph, tally)
    return tally.findings


def test_no_doubled_branch_begins_on_one_that_turns_beside_it():
    """1e-8 away; a cascade was stepped over."""
    assert findings(diagram("cavity", 404, 137)) == []


UNRESOLVED = [
    ("coupled", 4817, 1),  # beside an infinite multiplier rounding moves others over the circle
    ("coupled", 4817, 9),
    ("coupled", 4817, 33),
    ("absorber", 60611, 2),  # a virtual motion, all multipliers zero, begins at a stick
    ("level", 60611, 13),
]


@pytest.mark.parametrize(("kind", "salt", "seed"), UNRESOLVED)
def test_signs_of_rounding_where_a_branch_begins_are_nothing_unresolved(kind, salt, seed):
    assert not diagram(kind, salt, seed).unresolved


@pytest.mark.parametrize(
    ("kind", "seed", "word", "value"),
    [("cavity", 97, "LRts", 1.020020423), ("coupled", 229, "LsRs", 0.947625)],
)
def test_a_virtual_branch_is_real_where_the_simulation_follows_it(kind, seed, word, value):
    """Between two points of it, margins that were lost are positive again and others are not yet lost."""
    graph, followed = diagram(kind, 408, seed), []
    for branch in graph:
        passes = np.flatnonzero((branch.values[:-1] - value) * (branch.values[1:] - value) < 0.0)
        for i in passes if branch.description["word"] == word else ():
            share = (value - branch.values[i]) / (branch.values[i + 1] - branch.values[i])
            seen = replay(Between(branch, graph.within).orbit(int(i), float(share)))
            assert (seen.matches and seen.error < 1e-8) == branch.real
            followed.append(branch.real)
    assert followed.count(True) == 1


def test_a_doubling_right_behind_where_a_pair_splits():
    """Outside the circle a pair becomes two real multipliers, one of which enters 2e-10 (frequency) later: at -1 in eighty digits."""
    points = diagram("coupled", 4817, 45).of_kind("period-doubling")
    found = exact(min(points, key=lambda p: abs(p.value - 1.03026475831)).orbit)
    assert abs(found.shift) < 1e-14
    assert np.abs(found.multipliers + 1.0).min() < 1e-6


def test_a_slow_passage_beside_a_fold_is_no_attractor():
    """What it seems to repeat is, in eighty digits, the motion of a machine whose amplitude is 1e-8 larger: there the branch turns."""
    machine = draw("absorber", 414, 210).machine
    start = {"phase": 0.3196701108947567, "w": 0.07180270629232677, "w_rate": 1.231050380579057}
    found = find_attractor(machine, start, max_period=4, patience=1, amplitude=1.3923243664864222)
    assert found.kind == "chaotic" or abs(exact(found.orbit).shift) < 1e-10


def test_one_border_has_one_label():
    """LR grazes at both of its mirrored flights: a stick may begin at each (of positive or of negative duration), and four branches meet."""
    graph = diagram("coupled", 415, 33)
    (border,) = [
        p for p in graph.special.values() if p.kind in BORDERS and abs(p.value - 1.0001779826) < 1e-9
    ]
    for branch in graph:
        for i, label in branch.marks:
            if (
                label == border.label
            ):  # compared by impacts: times of a virtual motion may run backwards there
                orbit = branch.orbit(i)
                hits = [k for k, event in enumerate(orbit.word.events) if event in "LR"]
                np.testing.assert_allclose(orbit.nodes[hits], border.orbit.nodes, atol=1e-5)
    # where both sticks vanish a motion with unlike ones becomes symmetric, too: last bits decide which is the label
    ends = [
        (b, i)
        for b in graph
        for i, label in b.marks
        if b.description["word"] == "LsRs" and abs(graph.special[label].value - border.value) < 1e-13
    ]
    assert {b.real for b, _ in ends} == {True, False}
    durations = [b.orbit(1 if i == 0 else i - 1).durations[[1, 4]] for b, i in ends]
    signs = {tuple(np.sort(np.sign(pair))) for pair in durations}
    assert signs == {(1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)}


@pytest.mark.parametrize("fold", [1.33963555623378, 1.33963554542592])
def test_a_doubling_within_rounding_of_a_fold_is_said_to_be_unresolved(fold):
    """The multiplier that is 1 at the fold goes on through infinity and comes back through -1, 1e-14 and 3e-13 (amplitude) behind it: before and
    behind it is inside the circle, which a fold alone does not leave so."""
    graph = diagram("absorber", 9117, 59)
    point = min(graph.of_kind("fold"), key=lambda p: abs(p.value - fold))
    doublings = [p.value for p in graph.of_kind("period-doubling") if p.branch == point.branch]
    told = [0.5 * (u.low + u.high) for u in graph.unresolved if u.branch == point.branch]
    assert min(abs(x - fold) for x in doublings + told) < 1e-10


@pytest.mark.parametrize(("seed", "value"), [(336, 1.577211931470169), (396, 2.361212379735297)])
def test_a_branch_comes_home_though_steps_would_end_beside_the_doubling(seed, value):
    """Within 1e-5 of it tangents are rounding: a fold was told, and a branch went on as its own image.

    At which depth the branch that comes home is met depends on the last bit of the start: four levels hold it either way.
    """
    graph = diagram("cavity", 418, seed, depth=4)
    (point,) = [point for point in graph.special.values() if abs(point.value - value) < 1e-10]
    assert point.kind == "period-doubling"
    marked = [branch for branch in graph if any(label == point.label for _, label in branch.marks)]
    assert sum(branch.problem.periods > point.orbit.periods for branch in marked) == 1
    assert findings(graph) == []


def test_stable_up_to_a_pair_between_a_doubling_and_a_fold():
    """All within one step: over 1.4e-6 (frequency) behind the doubling, in eighty digits, until a pair has modulus 1 there as well."""
    graph = diagram("coupled", 112831, 30)
    (point,) = graph.of_kind("neimark-sacker")
    branch = graph[point.branch]
    index = next(i for i, label in branch.marks if label == point.label)
    before, there, behind = (
        np.abs(exact(orbit).multipliers).max()
        for orbit in (branch.orbit(index - 1), point.orbit, branch.orbit(index + 1))
    )
    assert there == pytest.approx(1.0, abs=1e-9)
    assert before < 1.0 - 1e-3 and behind > 1.0 + 1e-3
    assert replay(branch.orbit(index - 1), thorough=True).returned
