"""Branches put together from pieces: every point once, in order, whatever lies between and beside the points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.branches.half_branch import HalfBranch, Piece
from contvines.continuation.engine import Engine, Solved
from contvines.continuation.settings import Settings


def line(n=1):
    """u = p, n times over."""
    return cv.AlgebraicProblem(lambda u, p: u - p, [0.0] * n, 0.0)


ENGINE = Engine(line(), (-1.0, 1.0), Settings())


def piece(numbers, turned=False):
    values = np.array(numbers, dtype=float)
    sign = -1.0 if turned else 1.0
    tangents = sign * np.column_stack([values, values])
    arrays = (values[:, None], values, tangents, np.zeros((len(values), 0)), values)
    return Piece(*(array[::-1] if turned else array for array in arrays), turned=turned)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 4), st.booleans()), min_size=1, max_size=5), st.data())
def test_joining_turning_inserting(sizes, data):
    counter = iter(range(1000))
    half = HalfBranch([piece([float(next(counter)) for _ in range(size)], turned) for size, turned in sizes])
    n = len(half)
    assert half.joined().values.tolist() == list(range(n)) and half.end == n - 1.0
    back = half.reversed()
    assert back.joined().values.tolist() == list(range(n))[::-1]
    np.testing.assert_array_equal(back.joined().tangents[:, 0], -np.arange(n, dtype=float)[::-1])
    again = HalfBranch(half.pieces).reversed().reversed().extended(half, skip=1)
    assert again.joined().values.tolist() == [*range(n), *range(1, n)]
    i = data.draw(st.integers(0, n))
    point = Solved(np.array([-1.0]), -1.0, np.zeros(2), np.zeros(0), 0.0, 0.0, 0.0)
    more = half.inserted(ENGINE, [(i, point)])
    assert more.joined().values.tolist() == [*range(i), -1.0, *range(i, n)]
    assert more.since(np.array([-1.0])).joined().values.tolist() == [-1.0, *range(i, n)]


def test_branch_points_closer_than_roundoff_beside_a_point_of_the_branch():
    """Two pitchforks 6e-13 apart at p = 0, where the trivial branch has a point."""

    def f(u, p):
        return np.array([u[0] * (p - u[0] ** 2 + 0.3 * u[1]), u[1] * (p - 5.683e-13 - u[1] ** 2)])

    steps = {"first_step": 0.5, "max_step": 0.5, "max_branches": 1}
    problem = cv.AlgebraicProblem(f, [0.0, 0.0], -0.5, spectrum="flow")
    branch = cv.diagram(problem, within=(-0.5, 0.5), settings=steps)["B1"]
    assert (np.diff(branch.values) >= -1e-12).all()
    assert (branch.values == 0.5).sum() == 1


@pytest.mark.parametrize("large", [1.0, 1e10, 1e150])
def test_large_unknowns_are_not_mistaken_for_a_branch_that_runs_away(large):
    problem = cv.AlgebraicProblem(lambda u, p: u - large, [large] * 7, 0.0)
    branch = cv.diagram(problem, within=(0.0, 1.0))["B1"]
    assert "end of the interval" in branch.ended[1]


def test_unknowns_may_be_given_read_only_and_are_never_changed():
    u = np.zeros(2)
    u.setflags(write=False)
    engine = Engine(line(2), (-1.0, 1.0), Settings())
    found = engine.polish(u, 0.0, engine.at_parameter, 0.0)
    assert found is not None and found.residual == 0.0
    size = engine.row_sizes.max()  # residuals are relative to the rows
    assert engine.residual(u, 0.5) == pytest.approx(0.5 / size)
    with pytest.raises(ValueError, match="broadcast"):
        engine.at_value(np.zeros(3), 0.0)


class Keeping:
    """A journal that keeps what it is given, not copies."""

    def __init__(self):
        self.entries = {}

    def recall(self, key):
        return self.entries.get(key)

    def record(self, key, values):
        self.entries[key] = values

    def checkpoint(self, graph):
        pass


def test_chunks_in_a_journal_stay_what_they_were():
    def run(journal):
        problem = cv.MapProblem(lambda x, r: np.array([r * x[0] * (1.0 - x[0])]), [0.5], 2.5, parameter="r")
        steps = {"first_chunk": 5, "chunk": 5}
        return cv.diagram(problem, within=(2.0, 3.2), depth=0, settings=steps, journal=journal)["B1"]

    journal = Keeping()
    first, again = run(journal), run(journal)
    np.testing.assert_array_equal(first.multipliers, again.multipliers)
    np.testing.assert_allclose(first.multipliers[:, 0], 2.0 - first.values, atol=1e-12)
