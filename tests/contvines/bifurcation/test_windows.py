"""Windows in which a virtual branch is real: between two points that are both virtual, and found all the same."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from tests.contvines.lines import Line

CENTRES, HALVES = st.floats(-0.6, 0.6), st.floats(1e-5, 0.05)


def real_from_to(*margins):
    """Ends of the real branches of u = p, in order, with margins that are functions of p and negative where it begins."""
    problem = Line(lambda u, p: [margin(p) for margin in margins])
    graph = cv.diagram(problem, within=(-1.0, 1.0), virtual=True)
    assert graph.finished
    for branch in graph:
        if not branch.real:  # margins of its own points do not say otherwise
            assert branch.margin[1:-1].max(initial=-1.0) < 0.0
    return sorted(branch.range for branch in graph if branch.real)


WINDOWS = {
    "one margin comes back before another is lost": lambda a, b: [lambda p: p - a, lambda p: 2.0 * (b - p)],
    # as the time to a slip is: that of another slip before, of the right one, hardly positive, behind
    "the margin that comes back is told by a jump": lambda a, b: [
        lambda p: -3.0 - 0.1 * p if p < a else p - a,
        lambda p: b - p if p > 1.5 * a - 0.5 * b else np.inf,
    ],
    # as the reserve of friction does, which is the smaller one of two; no parabola through points on its sides is above zero
    "one rises above zero as a roof": lambda a, b: [lambda p: min(p - a, 0.5 * (b - p))],
    "a steeper roof": lambda a, b: [lambda p: min(p - a, 2.0 * (b - p))],
}


@pytest.mark.parametrize("margins", WINDOWS.values(), ids=WINDOWS)
@settings(max_examples=15)
@given(CENTRES, HALVES)
def test_a_window_is_found(margins, centre, half):
    ends = centre - half, centre + half
    assert real_from_to(*margins(*ends)) == [pytest.approx(ends, abs=1e-12)]


@settings(max_examples=15)
@given(CENTRES, st.floats(2e-3, 0.05))
def test_a_margin_rises_above_zero_between_two_points(centre, half):
    (found,) = real_from_to(lambda p: half**2 - (p - centre) ** 2)
    assert found == pytest.approx((centre - half, centre + half), abs=1e-12)


@settings(max_examples=10)
@given(CENTRES, st.one_of(HALVES, st.floats(-1e-7, 1e-7)))
def test_where_one_is_lost_before_the_other_comes_back_or_at_once_nothing_is_real(centre, gap):
    """As where one round gets what another one loses; margins are known to half their digits there."""
    assert not real_from_to(lambda p: p - centre - gap, lambda p: centre - p)
