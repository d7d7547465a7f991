"""Two graphs of one problem as one, against one graph of the whole."""

import pytest

import contvines as cv
from contvines.coexistence.merging import merge


def cubic(u, p):
    """u^3 - u = p: folds at p = -+ 2 / 27^(1/2)."""
    return p - u**3 + u


FOLD = 2.0 / 27.0**0.5


def graph(start, within):
    return cv.diagram(cv.AlgebraicProblem(cubic, [start], start**3 - start), within=within)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ((-0.2, 0.3), (0.25, 2.0)),
        ((0.2, 2.0), (-0.2, 0.4)),
        ((-1.0, 1.0), (0.3, 0.5)),
        ((0.2, 0.3), (-1.0, 1.0)),
    ],
)
def test_the_interval_is_that_of_both(first, second):
    one, other = graph(1.1, first), graph(1.15, second)
    merge(one, other)
    assert one.within == (min(first[0], second[0]), max(first[1], second[1]))


def test_what_both_have_is_kept_once():
    one, other = graph(1.1, (-1.0, 1.0)), graph(-1.1, (-0.9, 0.9))
    assert [len(g) for g in (one, other)] == [1, 1]
    called = merge(one, other)
    assert len(one) == 1 and called["B1"] == "B1"
    assert sorted(p.value for p in one.of_kind("fold")) == pytest.approx([-FOLD, FOLD], abs=1e-12)


def test_what_one_of_them_has_is_added():
    # 1.1^3 - 1.1 = 0.231: within so little of it the upper and the lower solutions are not connected
    one, other = graph(1.1, (0.2, 0.3)), graph(-0.2, (0.1, 0.35))
    called = merge(one, other)
    assert len(one) == 2 and called["B1"] == "B2"
    middle = one["B2"].points[len(one["B2"]) // 2, 0]
    assert cubic(middle, one["B2"].values[len(one["B2"]) // 2]) == pytest.approx(0.0, abs=1e-12)
    assert -0.5 < middle < 0.0
