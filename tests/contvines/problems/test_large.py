"""Sparse problems: folds and branch points against closed forms and against solves of their own."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, splu

import contvines as cv
from tools.benchmarks.large import bratu as bratu_2d
from tools.brusselator import brusselator

pytestmark = pytest.mark.slow


def second_difference(m, walls=1.0):
    """With zeros beyond its ends; with no flux there, on nodes that lie on them, if `walls` is 2."""
    beside = np.ones(m - 1)
    matrix = sp.diags_array([beside, -2.0 * np.ones(m), beside], offsets=[-1, 0, 1]).tolil()
    matrix[0, 1] = matrix[m - 1, m - 2] = walls
    return matrix.tocsc()


def matrix_free(jacobian, n):
    """The same as an operator."""

    def operator(u, p):
        matrix = jacobian(u, p)
        return LinearOperator((n, n), matvec=lambda x: matrix @ np.ravel(x), dtype=float)

    return operator


def test_turing_points_of_a_brusselator_on_a_line():
    """The homogeneous state (A, B/A) of 2 m = 1000 unknowns loses its stability to cos(k pi x) at B = (1 + D l)(A^2 + E l)/(E l).

    l = 4 m^2 sin(k pi/2 m)^2 are the eigenvalues of the second difference with no flux at the walls.
    """
    m, A, D, E = 500, 2.0, 0.02, 0.5
    F, jacobian, derivative = brusselator(m, A, D, E)
    start = np.tile([A, 2.0 / A], m)
    problem = cv.AlgebraicProblem(F, start, 2.0, "B", jacobian=jacobian, derivative=derivative)
    graph = cv.diagram(problem, within=(2.0, 2.16), depth=1, bounds={"u0": (1.95, 2.05)})
    lengths = 4.0 * m**2 * np.sin(np.arange(1, 5) * np.pi / (2 * m)) ** 2
    exact = min((1.0 + D * lengths) * (A**2 + E * lengths) / (E * lengths))
    (point,) = graph.on("B1")[1:-1]
    assert point.kind == "branch-point" and point.value == pytest.approx(exact, rel=1e-9)
    assert len(graph) == 2


@pytest.mark.parametrize("complex_step", [True, False])
def test_coloured_differences(complex_step):
    """A chain of 60 without a Jacobian: one call (or six) for each of three colours, and the fold of the dense problem."""
    m = 60
    line = second_difference(m) * (m + 1) ** 2
    calls = [0]

    def F(u, p):
        calls[0] += 1
        found = line @ u + p * np.exp(u)
        return found if complex_step else np.real(found)

    problem = cv.AlgebraicProblem(F, np.zeros(m), 0.0, sparsity=abs(line))
    assert problem.functions.complex_step == complex_step
    u = np.linspace(0.0, 1.0, m)
    calls[0] = 0
    found = problem.functions.jacobian(u, 2.0)
    assert calls[0] <= 3 * (1 if complex_step else 60) and sp.issparse(found)
    exact = line + sp.diags_array(2.0 * np.exp(u))
    assert abs(found - exact).max() < 1e-9 * abs(exact).max()
    assert np.count_nonzero(found.toarray()[np.abs(line.toarray()) == 0.0]) == 0


def test_without_a_matrix_from_the_start_through_the_fold():
    """Bratu on a square of 25 unknowns: GMRES with a preconditioner finds the fold, the points and the stability of the sparse problem."""
    n = 5
    F, jacobian, derivative = bratu_2d(n)
    N = n * n
    nearly = splu(jacobian(np.zeros(N), 0.0))

    def preconditioner(u, p):
        return LinearOperator((N, N), matvec=nearly.solve, dtype=float)

    graphs = []
    for given in (
        {"jacobian": jacobian},
        {"jacobian": matrix_free(jacobian, N), "preconditioner": preconditioner},
    ):
        problem = cv.AlgebraicProblem(
            F, np.zeros(N), 0.0, derivative=derivative, spectrum="flow", leading=3, **given
        )
        graphs.append(cv.diagram(problem, within=(0.0, 8.0), bounds={f"u{N // 2}": (None, 2.0)}))
    folds = [graph.of_kind("fold")[0] for graph in graphs]
    assert folds[1].value == pytest.approx(folds[0].value, rel=1e-12)
    branches = [graph["B1"] for graph in graphs]
    assert branches[1].values == pytest.approx(branches[0].values, rel=1e-8)
    assert np.array_equal(branches[0].stable, branches[1].stable)
    assert branches[0].stable.any() and not branches[0].stable.all()
    assert not graphs[1].of_kind("branch-point")


@pytest.mark.parametrize("spectrum", ["none", "flow"])
def test_double_points_without_a_matrix_and_without_a_preconditioner(spectrum):
    """lap u + p (u - u^3) = 0 on a square: simple at p = 2 l_1, double at l_1 + l_2, with l_k = 4 (m + 1)^2 sin(k pi / 2 (m + 1))^2."""
    m = 6
    line = (second_difference(m) * (m + 1.0) ** 2).tocsc()
    square = (sp.kron(line, sp.eye_array(m)) + sp.kron(sp.eye_array(m), line)).tocsc()
    problem = cv.AlgebraicProblem(
        lambda u, p: square @ u + p * (u - u**3),
        np.zeros(m * m),
        15.0,
        jacobian=matrix_free(lambda u, p: square + sp.diags_array(p * (1.0 - 3.0 * u**2)), m * m),
        derivative=lambda u, p: u - u**3,
        spectrum=spectrum,
        leading=4,
    )
    graph = cv.diagram(problem, within=(15.0, 60.0), depth=0)
    one, two = (4.0 * (m + 1) ** 2 * np.sin(0.5 * k * np.pi / (m + 1)) ** 2 for k in (1, 2))
    points = graph.of_kind("branch-point")
    assert [point.value for point in points] == pytest.approx([2.0 * one, one + two], rel=1e-10)
    if spectrum == "flow":
        np.testing.assert_allclose(graph["B1"].stable_intervals(), [(15.0, 2.0 * one)], rtol=1e-10)
