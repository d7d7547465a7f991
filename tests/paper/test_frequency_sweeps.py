"""Sweeps over frequency at G = 2.47 against the exact diagram: periodic attractors lie on its stable real branches, and
the sweep jumps where these end.

The simulator knows no branch and the continuation no simulation; the machine is that of `test_frequency_response.py`.
"""

from itertools import pairwise

import numpy as np
import pytest

import contvines as cv
from orbits.attractors.sweep import sweep
from orbits.cycles.identity import canonical
from orbits.starts.find import polish
from tests.machines import COUPLED

pytestmark = pytest.mark.slow

WITHIN = (0.94, 1.07)
# where a sweep has to jump; from integration, see test_frequency_response.py
UP = (0.9934295505152, 1.0254097153168)  # wall graze of the sliding motion, Neimark-Sacker point
DOWN = (1.0063834057387, 0.9717226436161)  # wall graze of the sliding motion, fold


class Atlas:
    """Diagrams, asked which stable real branch an attractor lies on."""

    def __init__(self, *graphs):
        self.graphs = graphs

    def find(self, orbit, value):
        """(graph, branch) whose orbit, solved for from the branch at the same value, has the same nodes within 1e-6."""
        target = canonical(orbit.word, orbit.periods, orbit.nodes)
        for graph in self.graphs:
            for branch in graph:
                if branch.real and self.on(branch, target, value):
                    return graph, branch
        return None

    @staticmethod
    def on(branch, target, value):
        gaps = branch.values - value
        for i in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
            share = gaps[i] / (gaps[i] - gaps[i + 1])
            guess = (1.0 - share) * branch.points[i] + share * branch.points[i + 1]
            solved = polish(branch.problem.orbit(guess, value))
            if solved is None or not (solved.real and solved.stable):
                continue
            key, nodes = canonical(solved.word, solved.periods, solved.nodes)
            if key == target[0] and np.abs(nodes - target[1]).max() < 1e-6:
                assert branch.stable[i] or branch.stable[i + 1]
                return True
        return False


def marks(graph, branch):
    """Values at which something happens to a branch: its own special points and those where others meet it."""
    met = {s.point for s in graph.switches if branch.label in (s.source, s.target)}
    points = [p for p in graph.special.values() if p.label in met or p.branch == branch.label]
    return [p for p in points if p.kind != "end"]


def goes_on(graph, branch, low, high):
    """The branch and those that continue it without a jump inside the step: through borders that a motion passes by
    persistence, and where the symmetry breaks or the period doubles supercritically."""
    reached, new = {branch.label}, [branch.label]
    while new:
        here = new.pop()
        for switch in graph.switches:
            point = graph[switch.point]
            smooth = "persistence" in switch.note or point.kind in ("symmetry-breaking", "period-doubling")
            if smooth and here in (switch.source, switch.target) and low <= point.value <= high:
                beyond = {switch.source, switch.target} - reached
                reached |= beyond
                new += beyond
    return [graph[label] for label in reached]


def stable_at(branch, value):
    return any(low <= value <= high for low, high in branch.stable_intervals())


@pytest.fixture(scope="module")
def atlas():
    """The diagram from the symmetric orbit, and that of an isola of asymmetric orbits that no switch leads to."""
    graph = cv.diagram(COUPLED.orbit("LR", frequency=1.01), over="frequency", within=WITHIN, depth=4)
    (row,) = sweep(COUPLED, "frequency", [0.994], start={"w": 0.5})
    isola = cv.diagram(row.detail.orbit, over="frequency", within=WITHIN, depth=2)
    return Atlas(graph, isola)


@pytest.mark.parametrize("direction", [1, -1])
def test_sweeps_follow_stable_branches_and_jump_where_these_end(atlas, direction):
    values = np.linspace(*WITHIN, 521)[::direction]
    rows = sweep(COUPLED, "frequency", values)
    places = []
    for row in rows:
        assert row.attractor in ("periodic", "sliding", "chaotic")
        places.append(None if row.attractor == "chaotic" else atlas.find(row.detail.orbit, row.value))
    recurrent = [row for row in rows if row.attractor != "chaotic"]
    lost = [row for row, place in zip(rows, places) if row.attractor != "chaotic" and place is None]
    # in the chaotic band a window of a word of three periods, off both diagrams, is met near 0.9975
    assert len(recurrent) > 490 and len(lost) <= 2
    assert all(
        0.9942 < row.value < 0.9992 and row.detail.orbit.real and row.detail.orbit.stable for row in lost
    )
    jumps = []
    for (before, after), (one, other) in zip(pairwise(rows), pairwise(places)):
        if before in lost or after in lost or (one is None and other is None):
            continue
        low, high = sorted((before.value, after.value))
        graph, branch = one or other
        chain = goes_on(graph, branch, low, high)
        if one is not None and other is not None and any(other[1] is follower for follower in chain):
            continue  # the same motion goes on
        away = after if one is not None else before  # where the motion of `branch` is no attractor any more
        assert not any(stable_at(follower, away.value) for follower in chain), (before, after)
        causes = [p for b in chain for p in marks(graph, b) if low <= p.value <= high]
        assert causes, (before, after)
        jumps.append((low, {p.kind for p in causes}))
    kinds = set().union(*(kinds for _, kinds in jumps))
    # up: wall graze, doublings, Neimark-Sacker point; down: wall grazes, doublings, folds
    assert {"wall-graze", "period-doubling"} <= kinds
    for value in UP if direction > 0 else DOWN:
        assert any(low <= value <= low + 2.5e-4 + 1e-12 for low, _ in jumps)
