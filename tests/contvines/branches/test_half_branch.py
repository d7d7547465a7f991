"""Branches put together from pieces: every point once, in order, whatever lies between and beside the points."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings


def line(n=1):
    """u = p, n times over."""
    return cv.AlgebraicProblem(lambda u, p: u - p, [0.0] * n, 0.0)


def test_branch_points_closer_than_roundoff_beside_a_point_of_the_branch():
    """Two pitchforks 6e-13 apart at p = 0, where the trivial branch has a point."""

    def f(u, p):
        return np.array([u[0] * (p - u[0] ** 2 + 0.3 * u[1]), u[1] * (p - 5.683e-13 - u[1] ** 2)])

    steps = {"first_step": 0.5, "max_step": 0.5, "max_branches": 1}
    problem = cv.AlgebraicProblem(f, [0.0, 0.0], -0.5, spectrum="flow")
    branch = cv.diagram(problem, within=(-0.5, 0.5), settings=steps)["B1"]
    assert (np.diff(branch.values) >= -1e-12).all()
    assert (branch.values == 0.5).sum() == 1


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
