"""Windows in which a virtual branch is real: between two points that are both virtual, and found all the same."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.problems.dense import KERNELS
from contvines.problems.protocol import Kernels
from tests.contvines.bifurcation.test_dips import Line

CENTRES, HALVES = st.floats(-0.6, 0.6), st.floats(1e-5, 0.05)


class Virtual(Line):
    """u = p, with margins that are given functions of p and negative where the branch begins."""

    def __init__(self, *margins):
        def inspect(data, u, p, work, row):
            row[:] = 0.5, 0.0, *(margin(p) for margin in margins)

        super().__init__()
        self.n_margins = len(margins)
        self.kernels = Kernels(KERNELS.linearise, KERNELS.bordered, inspect)


def real_from_to(*margins):
    """Ends of the real branches of a diagram, in order."""
    graph = cv.diagram(Virtual(*margins), within=(-1.0, 1.0), virtual=True)
    assert graph.finished
    for branch in graph:
        if not branch.real:  # margins of its own points do not say otherwise
            assert branch.margin[1:-1].max(initial=-1.0) < 0.0
    return sorted(branch.range for branch in graph if branch.real)


@settings(max_examples=15, deadline=None)
@given(CENTRES, HALVES)
def test_one_margin_comes_back_before_another_is_lost(centre, half):
    (found,) = real_from_to(lambda p: p - centre + half, lambda p: 2.0 * (centre + half - p))
    assert found == pytest.approx((centre - half, centre + half), abs=1e-12)


@settings(max_examples=15, deadline=None)
@given(CENTRES, HALVES)
def test_the_margin_that_comes_back_is_told_by_a_jump(centre, half):
    """As the time to a slip is: that of another slip before, of the right one, hardly positive, behind."""
    (found,) = real_from_to(
        lambda p: -3.0 - 0.1 * p if p < centre - half else p - centre + half,
        lambda p: centre + half - p if p > centre - 2.0 * half else np.inf,
    )
    assert found == pytest.approx((centre - half, centre + half), abs=1e-12)


@settings(max_examples=15, deadline=None)
@given(CENTRES, st.floats(2e-3, 0.05))
def test_a_margin_rises_above_zero_between_two_points(centre, half):
    (found,) = real_from_to(lambda p: half**2 - (p - centre) ** 2)
    assert found == pytest.approx((centre - half, centre + half), abs=1e-12)


@settings(max_examples=15, deadline=None)
@given(CENTRES, HALVES, st.floats(0.5, 2.0))
def test_a_margin_rises_above_zero_as_a_roof(centre, half, slope):
    """As the reserve of friction does, which is the smaller one of two. No parabola through points on its sides is above zero."""
    (found,) = real_from_to(lambda p: min(p - centre + half, slope * (centre + half - p)))
    assert found == pytest.approx((centre - half, centre + half), abs=1e-12)


@settings(max_examples=10, deadline=None)
@given(CENTRES, HALVES)
def test_where_one_is_lost_before_the_other_comes_back_nothing_is_real(centre, half):
    assert not real_from_to(lambda p: p - centre - half, lambda p: centre - half - p)


@settings(max_examples=10, deadline=None)
@given(CENTRES, st.floats(-1e-7, 1e-7))
def test_margins_that_change_places_at_one_point_leave_no_window(centre, rounding):
    """As where one round gets what another one loses; margins are known to half their digits there."""
    assert not real_from_to(lambda p: p - centre + rounding, lambda p: centre - p)
