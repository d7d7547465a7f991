"""Sparse problems: folds and branch points against closed forms and against solves of their own."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contvines as cv
from contvines.problems.factors import BandFactors, Method, SuperLUFactors
from tests.benchmarks.large import bratu as bratu_2d


def second_difference(m, neumann=False):
    matrix = sp.diags_array([np.ones(m - 1), -2.0 * np.ones(m), np.ones(m - 1)], offsets=[-1, 0, 1]).tolil()
    if neumann:
        matrix[0, 0] = matrix[m - 1, m - 1] = -1.0
    return matrix.tocsc()


def test_turing_points_of_a_brusselator_on_a_line():
    """The homogeneous state (A, B/A) of 2 m = 1000 unknowns loses its stability to cos(k pi x) at B = (1 + D l)(A^2 + E l)/(E l).

    l = 4 m^2 sin(k pi/2 m)^2 are the eigenvalues of the second difference with no flux at the walls.
    """
    m, A, D, E = 500, 2.0, 0.02, 0.5
    order = np.arange(2 * m).reshape(2, m).T.reshape(-1)
    line = second_difference(m, True) * m**2
    diffusion = sp.block_diag([D * line, E * line]).tocsc()[order][:, order].tocsc()

    def F(w, b):
        u, v = w[0::2], w[1::2]
        out = diffusion @ w
        out[0::2] += A - (b + 1.0) * u + u * u * v
        out[1::2] += b * u - u * u * v
        return out

    def jacobian(w, b):
        u, v = w[0::2], w[1::2]
        here, above, below = np.empty(2 * m), np.zeros(2 * m - 1), np.zeros(2 * m - 1)
        here[0::2], here[1::2] = -(b + 1.0) + 2.0 * u * v, -u * u
        above[0::2], below[0::2] = u * u, b - 2.0 * u * v
        return (diffusion + sp.diags_array([below, here, above], offsets=[-1, 0, 1])).tocsc()

    def derivative(w, b):
        out = np.empty(2 * m)
        out[0::2], out[1::2] = -w[0::2], w[0::2]
        return out

    start = np.tile([A, 2.0 / A], m)
    problem = cv.AlgebraicProblem(F, start, 2.0, "B", jacobian=jacobian, derivative=derivative)
    graph = cv.diagram(problem, within=(2.0, 2.16), depth=1, bounds={"u0": (1.95, 2.05)})
    lengths = 4.0 * m**2 * np.sin(np.arange(1, 5) * np.pi / (2 * m)) ** 2
    exact = min((1.0 + D * lengths) * (A**2 + E * lengths) / (E * lengths))
    (point,) = graph.on("B1")[1:-1]
    assert point.kind == "branch-point" and point.value == pytest.approx(exact, rel=1e-9)
    assert len(graph) == 2


def test_the_fold_of_bratu_on_a_line():
    """500 unknowns; the witness shoots from the middle in 30 digits and finds where p(u(1/2)) is stationary."""
    n = 499
    laplace = second_difference(n) * (n + 1) ** 2
    problem = cv.AlgebraicProblem(
        lambda u, p: laplace @ u + p * np.exp(u),
        np.zeros(n),
        0.0,
        jacobian=lambda u, p: (laplace + sp.diags_array(p * np.exp(u))).tocsc(),
        derivative=lambda u, p: np.exp(u),
        outputs={"middle": lambda u, p: u[n // 2]},
    )
    graph = cv.diagram(problem, within=(0.0, 4.0), bounds={"middle": (None, 2.0)})
    (point,) = graph.of_kind("fold")
    with mp.workdps(30):
        h2, half = mp.mpf(1) / (n + 1) ** 2, (n + 1) // 2

        def at_the_wall(middle, p):
            here, following = middle, middle - h2 * p * mp.exp(middle) / 2
            for _ in range(half - 1):
                here, following = following, 2 * following - here - h2 * p * mp.exp(following)
            return following

        def value(middle, guess):
            return mp.findroot(
                lambda p: at_the_wall(middle, p), (guess, guess * (1 + mp.mpf(10) ** -6)), tol=1e-50
            )

        middle, p, step = mp.mpf(float(point.u[n // 2])), mp.mpf(point.value), mp.mpf("1e-4")
        low, here, high = (value(middle + s, p) for s in (-step, 0, step))
        middle += step * (low - high) / (low - 2 * here + high) / 2
        exact = value(middle, p)
    assert point.value == pytest.approx(float(exact), rel=1e-11)


def test_two_dimensional_bratu():
    """900 unknowns; the fold again by Newton's method for F = 0, F_u v = 0, v.v = 1, starting 1e-3 away."""
    n = 30
    F, jacobian, derivative = bratu_2d(n)
    N = n * n
    problem = cv.AlgebraicProblem(F, np.zeros(N), 0.0, jacobian=jacobian, derivative=derivative)
    graph = cv.diagram(problem, within=(0.0, 8.0), bounds={f"u{N // 2 + n // 2}": (None, 2.0)})
    (point,) = graph.of_kind("fold")
    u, p = point.u * 1.001, point.value * 0.999
    v = splu(jacobian(u, p)).solve(np.ones(N))
    v /= np.linalg.norm(v)
    for _ in range(8):
        J, e = jacobian(u, p), np.exp(u)
        whole = sp.bmat(
            [
                [J, None, e[:, None]],
                [sp.diags_array(p * e * v), J, (e * v)[:, None]],
                [None, v[None, :], None],
            ],
            format="csc",
        )
        step = splu(whole).solve(-np.concatenate([F(u, p), J @ v, [0.5 * (v @ v - 1.0)]]))
        u, v, p = u + step[:N], v + step[N : 2 * N], p + step[-1]
    assert point.value == pytest.approx(p, rel=1e-12)


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


def test_a_pattern_that_lacks_an_entry_is_refused():
    line = second_difference(30)

    def F(u, p):
        found = line @ u + p
        found[7] += u[20]
        return found

    with pytest.raises(ValueError, match=r"sparsity lacks an entry of F in row 7"):
        cv.AlgebraicProblem(F, np.zeros(30), 0.0, sparsity=line != 0.0)
    with pytest.raises(ValueError, match=r"\(3, 3\)"):
        cv.AlgebraicProblem(F, np.zeros(30), 0.0, sparsity=np.ones((3, 3)))


def test_banded_factors_are_those_of_numpy():
    """A shuffled band: solutions and the sign of the determinant."""
    draw = np.random.default_rng(6)
    n = 40
    for k in range(6):
        matrix = np.zeros((n, n))
        for d in (-2, -1, 0, 1):
            matrix += np.diag(draw.standard_normal(n - abs(d)), d)
        order = np.arange(n) if k % 2 else draw.permutation(n)
        matrix = matrix[order][:, order]
        method, sides = Method(), draw.standard_normal((n, 2))
        factors = method.factorise(sp.csc_matrix(matrix))
        assert isinstance(factors, BandFactors)
        np.testing.assert_allclose(factors.solve(sides), np.linalg.solve(matrix, sides), rtol=1e-6)
        np.testing.assert_allclose(
            factors.solve(sides[:, 0]), np.linalg.solve(matrix, sides[:, 0]), rtol=1e-6
        )
        assert factors.sign == SuperLUFactors(sp.csc_matrix(matrix), "COLAMD").sign
        assert factors.sign == np.linalg.slogdet(matrix)[0]
