"""Borders, with a toy whose words and margins are known in closed form.

Word "a": u = p, real for p < 1/2 (margin 1/2 - p). Word "b": u = 1 - p or 2 p - 1/2, real for p > 1/2 (persistence) or for
p < 1/2 (a nonsmooth fold). All meet in u = 1/2.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.dense import KERNELS, DenseWork
from contvines.problems.protocol import Kernels, ProblemDefaults, Seed


def inspect(data, u, p, work, row):
    row[0], row[1] = data.multiplier(p), 0.0
    row[2:] = data.margins(u, p)


class Line(ProblemDefaults):
    """u = offset + slope p with margins sides * (p - at)."""

    dimension, n_multipliers, spectrum, parameter = 1, 1, "map", "p"
    kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)

    def __init__(self, word, offset, slope, sides, at, beyond=(), multiplier=0.5):
        self.word, self.offset, self.slope = word, offset, slope
        self.sides, self.at, self.others = np.array(sides), np.array(at), beyond
        self.n_margins = len(sides)
        self.data, self.m = self, multiplier
        self.u0, self.p0 = np.array([offset + 0.3 * slope]), 0.3

    def multiplier(self, p):
        return self.m

    def workspace(self):
        return DenseWork(1)

    def equations(self, u, p):
        return u - self.offset - self.slope * p, np.eye(1), np.array([-self.slope])

    def margins(self, u, p):
        return self.sides * (p - self.at)

    def margin_kind(self, j):
        return ("velocity-graze", "wall-graze")[j]

    def beyond(self, point):
        self.seen = point
        return [f(self, point) for f in self.others]

    def canonical(self, u, p):
        return self.word, u

    def describe(self):
        return {"name": "line", "word": self.word, "factory": None}


def persistent(line, point):
    other = Line("b", -0.5, 2.0, [1.0], [0.5], multiplier=1.5)
    return Seed(other, np.array([0.52]), 0.51, None, "border", "persistence", True)


def folding(line, point):
    other = Line("b", 1.0, -1.0, [-1.0], [0.5], multiplier=1.5)
    return Seed(other, np.array([0.51]), 0.49, None, "border", "nonsmooth fold", False)


def test_a_branch_ends_at_its_border_exactly():
    line = Line("a", 0.0, 1.0, [-1.0], [0.5])
    graph = cv.diagram(line, within=(0.0, 1.0))
    assert list(graph.branches) == ["B1"] and graph["VG1"].kind == "velocity-graze"
    assert abs(graph["VG1"].value - 0.5) < 1e-13
    assert graph["B1"].values[-1] == graph["VG1"].value and graph["B1"].margin.min() > -1e-13
    assert "VG1" in graph["B1"].ended[1] and graph["B1"].real
    assert line.seen.tangent[-1] > 0.0 and line.seen.margin_index == 0  # handed over pointing outward


def test_persistence_goes_on_with_the_new_word_and_both_sides_share_the_label():
    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [persistent]), within=(0.0, 1.0), depth=0)
    assert [b.description["word"] for b in graph] == ["a", "b"]
    assert [(s.point, s.source, s.target) for s in graph.switches] == [("VG1", "B1", "B2")]
    assert [p.label for p in graph.special.values() if p.kind == "velocity-graze"] == ["VG1"]
    assert abs(graph["B2"].values[0] - 0.5) < 1e-13 and graph["B2"].values[-1] == 1.0
    assert "meets B1 at VG1" in graph["B2"].ended[0]
    # a stability change without any multiplier on the circle is kept
    assert graph["VG1"].multipliers[0] == pytest.approx(0.5)
    assert graph["VG1"].multipliers_beyond[0] == pytest.approx(1.5)
    assert graph["B1"].stable.all() and not graph["B2"].stable.any()


def test_nonsmooth_fold_is_a_switch():
    start = Line("a", 0.0, 1.0, [-1.0], [0.5], [folding])
    shallow = cv.diagram(start, within=(0.0, 1.0), depth=0)
    assert len(shallow) == 1 and "depth = 0" in shallow["VG1"].note
    graph = cv.diagram(start, within=(0.0, 1.0), depth=1)
    assert graph["B2"].range == pytest.approx((0.0, 0.5)) and graph.switches[0].note == "nonsmooth fold"
    assert "depth" not in graph["VG1"].note


def test_virtual_part_is_a_branch_of_its_own():
    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [persistent]), within=(0.0, 1.0), virtual=True)
    assert [b.real for b in graph] == [True, True, False]
    rest = next(b for b in graph if not b.real)
    assert rest.range == pytest.approx((0.5, 1.0)) and rest.description["word"] == "a"
    assert len(graph.of_kind("velocity-graze")) == 1
    assert [(s.point, s.source, s.target) for s in graph.switches] == [
        ("VG1", "B1", "B2"),
        ("VG1", "B1", "B3"),
    ]


def test_start_beyond_a_border_is_refused():
    line = Line("a", 0.0, 1.0, [-1.0], [0.2])
    with pytest.raises(ValueError, match="beyond a border"):
        cv.diagram(line, within=(0.0, 1.0))
    graph = cv.diagram(line, within=(0.0, 1.0), virtual=True)
    assert not graph["B1"].real and abs(graph["VG1"].value - 0.2) < 1e-13 and graph["B2"].real


@pytest.mark.parametrize("slope", [1e-6, 1e-8])
@pytest.mark.parametrize("max_step", [0.03, 0.0071, 0.003, 0.0013])
def test_where_a_margin_is_flat_the_border_says_how_well_it_is_known(max_step, slope):
    """Its margin, slope (1/2 - p), is rounding far around p = 1/2: points beside it, of either sign, count as real."""

    class Flat(Line):
        def margins(self, u, p):
            return np.array([slope * (0.5 - p)])

    graph = cv.diagram(Flat("a", 0.0, 1.0, [1.0], [0.0]), within=(0.0, 1.0), settings={"max_step": max_step})
    border = graph["VG1"]
    assert abs(border.value - 0.5) <= 2.0 * border.location_error + 1e-12
    assert border.location_error <= 2e-12 / slope


@pytest.mark.parametrize("max_step", [0.03, 0.007])
@pytest.mark.parametrize("behind", [0.0, 3e-6])
def test_where_the_parameter_turns_back_at_a_border_there_is_no_fold(max_step, behind):
    """t = u with p = -t^2 and the margin t, as where a stick vanishes: the branch ends where p is stationary, to rounding."""

    class Turning(Line):
        u0, p0 = np.array([0.7]), -0.49

        def equations(self, u, p):
            return np.array([p + u[0] ** 2]), np.array([[2.0 * u[0]]]), np.array([1.0])

        def margins(self, u, p):
            return np.array([u[0] + behind])

    problem = Turning("t", 0.0, 1.0, [1.0], [0.0])
    problem.u0, problem.p0 = np.array([0.7]), -0.49
    graph = cv.diagram(problem, within=(-1.0, 1.0), settings={"max_step": max_step})
    assert [point.kind for point in graph.special.values() if point.kind != "end"] == ["velocity-graze"]
    assert graph["VG1"].value == pytest.approx(-(behind**2), abs=1e-13)
