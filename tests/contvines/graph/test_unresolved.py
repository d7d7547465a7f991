"""Where both ends of a stretch do not agree with what is found between, the graph says so, with what is certain on both sides."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.graph.contents import Unresolved, sentences
from contvines.graph.label_special_points import _unresolved


def jumping(before, after, **settings):
    """The fixed point u = p of a map whose multiplier jumps at p = 0.3."""
    problem = cv.MapProblem(lambda u, p: [p + (before if p < 0.3 else after) * (u[0] - p)], u0=[0.1], p0=0.1)
    return cv.diagram(problem, within=(0.0, 1.0), depth=0, settings=settings)


@pytest.mark.parametrize(
    ("before", "after", "counts"),
    [(-0.5, -1.5, ((0, 0, 0), (0, 1, 0))), (-1.7, -0.2, ((0, 1, 0), (0, 0, 0)))],
)
def test_a_multiplier_that_jumps_over_the_circle_is_no_special_point(before, after, counts):
    graph = jumping(before, after)
    assert {point.kind for point in graph.special.values()} == {"end"}
    (found,) = graph.unresolved
    assert found.branch == "B1" and found.reason == "multipliers"
    assert found.low <= 0.3 <= found.high and found.high - found.low < 1e-6
    numbers = (found.before, found.after)
    assert numbers == counts or numbers == counts[::-1]
    stable = [(0.0, 0.3)] if abs(before) < 1.0 else [(0.3, 1.0)]
    assert graph["B1"].stable_intervals() == [pytest.approx(stable[0], abs=1e-6)]


def test_a_branch_whose_parts_are_spent_says_so():
    """The stretch is as long as it was when it was halved for the last time, around the jump all the same."""
    (closely,), (found,) = jumping(-0.5, -1.5).unresolved, jumping(-0.5, -1.5, parts=3).unresolved
    assert found.reason == "parts" and found.low <= 0.3 <= found.high
    assert found.high - found.low > 100.0 * (closely.high - closely.low)
    assert "settings.parts" in found.sentence("p") and {found.before, found.after} == {(0, 0, 0), (0, 1, 0)}


def test_many_stretches_of_one_branch_are_counted():
    stretches = [Unresolved(branch, 0.1, 0.2, k, "determinant") for branch in ("B1", "B2") for k in range(12)]
    lines = sentences(stretches[:13], "p")
    assert (
        sum("on B1 at p" in line for line in lines) == 10 and sum("on B2 at p" in line for line in lines) == 1
    )
    assert lines[-1].startswith("unresolved on B1: 2 more")


class Line:
    """A branch of seven points, stable between the second and the last but one."""

    label, marks = "B1", ()

    def __init__(self):
        self.stable = np.array([False, *[True] * 5, False])

    def __len__(self):
        return len(self.stable)


@pytest.mark.parametrize(("error", "together"), [(1e-9, True), (1e-13, False)])
def test_nothing_is_stable_between_stretches_nearer_than_their_errors(error, together):
    run = SimpleNamespace(graph=SimpleNamespace(special={}), unit=lambda value: 1.0)
    counts = (1, 0, 0), (0, 0, 0)
    one = Unresolved("B1", 0.3, 0.3 + 1e-11, 1, "multipliers", *counts)
    other = Unresolved("B1", 0.3 + 1e-10, 0.3 + 1.1e-10, 5, "multipliers", *counts[::-1])
    branch = Line()
    found = _unresolved(run, branch, [(one, error), (other, error)])
    assert branch.stable.any() != together
    whole = Unresolved("B1", one.low, other.high, 1, "multipliers", one.before, other.after)
    assert found == ([whole] if together else [one, other])
