"""What is told of equations by a look round their start."""

import numpy as np

import contvines as cv


def test_equations_that_start_flat_are_equations():
    flat = cv.AlgebraicProblem(lambda u, p: [u[0] - p, max(u[1] - 2.0, 0.0)], [0.0, 1.0], 0.0)
    assert (flat.dimension, list(flat.u0)) == (2, [0.0, 1.0])
    assert cv.AlgebraicProblem(lambda u, p: u**5, [0.0], 0.0).dimension == 1


def test_a_root_at_the_start_is_no_noise():
    """sqrt |u| = p is u = p^2, and u = -p^2, from u = p = 0: followed to the end in few points or said to have a kink."""
    problem = cv.AlgebraicProblem(lambda u, p: np.sqrt(np.abs(u)) - p, [0.0], 0.0)
    assert problem.noise == 0.0 and not problem.functions.noise.any()
    try:
        graph = cv.diagram(problem, within=(-1.0, 1.0))
    except ValueError as error:
        assert "kink" in str(error) or "singular" in str(error) or "converge" in str(error)
    else:
        assert sum(len(branch.values) for branch in graph) < 500
