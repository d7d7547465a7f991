"""Borders, with words whose margins are known in closed form (`tests/contvines/lines.py`); all of them meet in u = 1/2 at p = 1/2."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.lines import Word, ending, folding, persistent, seed

UNIT = (0.0, 1.0)


def words_of(graph):
    return [branch.description["word"] for branch in graph]


def borders_of(graph):
    return [point for point in graph.special.values() if point.kind != "end"]


def test_persistence_goes_on_with_the_new_word_and_both_sides_share_the_label():
    line = ending(persistent)
    graph = cv.diagram(line, within=UNIT, depth=0)
    one, other = graph
    (border,) = borders_of(graph)
    assert words_of(graph) == ["a", "b"]
    assert (border.label, border.kind) == ("VG1", "velocity-graze") and abs(border.value - 0.5) < 1e-13
    assert one.values[-1] == border.value and one.margin.min() > -1e-13 and one.real
    assert "VG1" in one.ended[1] and "meets B1 at VG1" in other.ended[0]
    assert line.seen.tangent[-1] > 0.0 and line.seen.margin_index == 0  # handed over pointing outward
    assert [(s.point, s.source, s.target) for s in graph.switches] == [("VG1", "B1", "B2")]
    assert abs(other.values[0] - 0.5) < 1e-13 and other.values[-1] == 1.0
    # a stability change without any multiplier on the circle is kept
    assert border.multipliers[0] == pytest.approx(0.5) and border.multipliers_beyond[0] == pytest.approx(1.5)
    assert one.stable.all() and not other.stable.any()


def test_nonsmooth_fold_is_a_switch():
    shallow = cv.diagram(ending(folding), within=UNIT, depth=0)
    assert len(shallow) == 1 and "depth = 0" in shallow["VG1"].note
    assert "(the solutions found beyond are not followed: depth = 0)" in str(shallow)
    graph = cv.diagram(ending(folding), within=UNIT, depth=1)
    assert graph["B2"].range == pytest.approx((0.0, 0.5))
    assert "depth" not in graph["VG1"].note and "B1 -> B2 (nonsmooth fold)" in str(graph)


def test_virtual_part_is_a_branch_of_its_own():
    graph = cv.diagram(ending(persistent), within=UNIT, virtual=True)
    assert [b.real for b in graph] == [True, True, False]
    rest = next(b for b in graph if not b.real)
    assert rest.range == pytest.approx((0.5, 1.0)) and rest.description["word"] == "a"
    assert len(graph.of_kind("velocity-graze")) == 1
    ties = [(s.point, s.source, s.target) for s in graph.switches]
    assert ties == [("VG1", "B1", "B2"), ("VG1", "B1", "B3")]


def test_start_beyond_a_border_is_refused():
    line = Word("a", 0.0, 1.0, [-1.0], [0.2])
    with pytest.raises(ValueError, match="beyond a border"):
        cv.diagram(line, within=UNIT)
    graph = cv.diagram(line, within=UNIT, virtual=True)
    assert not graph["B1"].real and abs(graph["VG1"].value - 0.2) < 1e-13 and graph["B2"].real


@pytest.mark.parametrize("slope", [1e-6, 1e-8])
@pytest.mark.parametrize("max_step", [0.03, 0.0071, 0.003, 0.0013])
def test_where_a_margin_is_flat_the_border_says_how_well_it_is_known(max_step, slope):
    """Its margin, slope (1/2 - p), is rounding far around p = 1/2: points beside it, of either sign, count as real."""
    flat = Word("a", 0.0, 1.0, [-slope], [0.5])
    border = cv.diagram(flat, within=UNIT, settings={"max_step": max_step})["VG1"]
    assert abs(border.value - 0.5) <= 2.0 * border.location_error + 1e-12
    assert border.location_error <= 2e-12 / slope


@pytest.mark.parametrize("max_step", [0.03, 0.007])
@pytest.mark.parametrize("behind", [0.0, 3e-6])
def test_where_the_parameter_turns_back_at_a_border_there_is_no_fold(max_step, behind):
    """p = -u^2 with the margin u, as where a stick vanishes: the branch ends where p is stationary, to rounding."""
    problem = Word(
        "t", 0.0, 1.0,
        margins=lambda u, p: [u + behind], curve=lambda u, p: (p + u**2, 2.0 * u, 1.0), start=(0.7, -0.49),
    )  # fmt: skip
    graph = cv.diagram(problem, within=(-1.0, 1.0), settings={"max_step": max_step})
    assert [point.kind for point in borders_of(graph)] == ["velocity-graze"]
    assert graph["VG1"].value == pytest.approx(-(behind**2), abs=1e-13)


@pytest.mark.parametrize("gap", [1e-9, 1e-7, 3e-6, 0.02])
def test_a_branch_that_passes_by_does_not_begin_at_the_border(gap):
    """Word "b" lasts from 1/2 + gap to 0.9: a seed on it is real and close, but nothing joins it to the border at 1/2."""

    def passing(line, point):
        return seed(Word("b", -0.5, 2.0, [1.0, -1.0], [0.5 + gap, 0.9]), 0.56, 0.53)

    graph = cv.diagram(ending(passing), within=UNIT)
    assert list(graph.branches) == ["B1"] and not graph.switches
    assert [point.value for point in borders_of(graph)] == pytest.approx([0.5])
    assert "does not begin here" in graph["VG1"].note


@pytest.mark.parametrize("width", [2e-3, 2e-4, 3e-5])
def test_a_short_branch_on_which_the_parameter_hardly_moves_is_followed(width):
    """Word "b": u from 1/2 to 1/2 + width, while p changes by 1e-9 of that, as where the speed of an impact grows from nothing."""

    def steep(line, point):
        other = Word(
            "b", 0.0, 1.0,
            margins=lambda u, p: [u - 0.5, 0.5 + width - u],
            curve=lambda u, p: (p - 0.5 - 1e-9 * (u - 0.5), -1e-9, 1.0),
        )  # fmt: skip
        return seed(other, 0.5 + 1e-7, 0.5 + 1e-16)

    graph = cv.diagram(ending(steep), within=UNIT)
    assert words_of(graph) == ["a", "b"]
    ends = sorted(float(u) for u in graph["B2"].points[[0, -1], 0])
    assert ends == pytest.approx([0.5, 0.5 + width], abs=1e-9)


# ------------------------------------------------------------------ a problem that fails at one of its borders
FAILURE = ZeroDivisionError("no such motion")


class Failing(Word):
    """Word "a", real for 0.2 < p < 0.5, fails in one of the questions that a border asks, at the border p = 0.2; beyond p = 0.5 goes on word "b"."""

    def __init__(self, where, error=FAILURE):
        super().__init__("a", 0.0, 1.0, [1.0, -1.0], [0.2, 0.5])
        self.where, self.error = where, error

    def fail(self, where, p):
        if where == self.where and p < 0.3:
            raise self.error

    def beyond(self, point):
        self.fail("beyond", point.value)
        if point.value > 0.3:
            return [persistent(self, point)]
        if self.where != "root":
            return []
        other = Word("c", 0.0, -1.0, [-1.0], [0.2])
        other.root = lambda u, p: self.fail("root", p)  # is asked for a shorter solution
        return [seed(other, -0.1, 0.1)]

    def dead_end(self, point):
        self.fail("dead_end", point.value)
        return ""


@pytest.mark.parametrize("where", ["beyond", "dead_end", "root"])
def test_an_error_at_one_border_costs_nothing_else_and_is_named(where):
    graph = cv.diagram(Failing(where), within=UNIT)
    assert graph.finished and words_of(graph) == ["a", "b"]
    np.testing.assert_allclose([b.range for b in graph], [(0.2, 0.5), (0.5, 1.0)], atol=1e-13)
    failed, crossed = sorted(borders_of(graph), key=lambda point: point.value)
    assert "ZeroDivisionError: no such motion" in failed.note and crossed.note == ""
    assert [switch.point for switch in graph.switches] == [crossed.label]


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError])
def test_an_interrupt_or_a_full_machine_is_no_error_of_a_border(error):
    with pytest.raises(error):
        cv.diagram(Failing("beyond", error()), within=UNIT)
