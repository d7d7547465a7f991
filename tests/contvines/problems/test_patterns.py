"""Patterns in fields: snaking of localised states of Swift and Hohenberg's equation, oscillations of a brusselator on a line."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contvines as cv

pytestmark = pytest.mark.slow


def neumann(n, h):
    """Second difference with no flux at the ends, on nodes that lie on them."""
    matrix = sp.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]).tolil()
    matrix[0, 1] = matrix[n - 1, n - 2] = 2.0
    return (matrix / h**2).tocsc()


def fold_of(F, jacobian, slope, second, mixed, u, p):
    """The fold near (u, p) by Newton's method for F = 0, F_u v = 0, v.v = 1; nothing of the package's.

    ``second`` (u, v) is the diagonal of (F_u v)_u, ``mixed`` (v) is (F_u v)_p.
    """
    n = len(u)
    v = splu(jacobian(u, p)).solve(np.ones(n))
    v = splu(jacobian(u, p)).solve(v / np.abs(v).max())
    v /= np.linalg.norm(v)
    for _ in range(8):
        matrix = jacobian(u, p)
        whole = sp.bmat(
            [
                [matrix, None, slope(u)[:, None]],
                [sp.diags_array(second(u, v)), matrix, mixed(v)[:, None]],
                [None, v[None, :], None],
            ],
            format="csc",
        )
        step = splu(whole).solve(-np.concatenate([F(u, p), matrix @ v, [0.5 * (v @ v - 1.0)]]))
        u, v, p = u + step[:n], v + step[n : 2 * n], p + step[-1]
    return float(p)


def test_localised_states_snake():
    """u' = r u - (1 + d^2/dx^2)^2 u + 1.6 u^2 - u^3 on half a line, even about its middle: fold after fold, each to roundoff.

    The folds on either side come to lie at two values, the ends of the pinning region (Burke and Knobloch, Phys. Rev. E 73 (2006) 056211).
    """
    n, length = 120, 30.0
    x = np.linspace(0.0, length, n)
    inner = sp.identity(n) + neumann(n, x[1])
    operator = -(inner @ inner).tocsc()

    def F(u, r):
        return r * u + operator @ u + 1.6 * u**2 - u**3

    def jacobian(u, r):
        return (operator + sp.diags_array(r + 3.2 * u - 3.0 * u**2)).tocsc()

    weights = np.full(n, x[1])
    weights[[0, -1]] *= 0.5
    problem = cv.AlgebraicProblem(
        F,
        1.2 * np.cos(x) / np.cosh(x / 6.0),
        -0.2,
        "r",
        jacobian=jacobian,
        derivative=lambda u, r: u,
        outputs={"mass": lambda u, r: float(weights @ u**2)},
    )
    graph = cv.diagram(problem, within=(-0.5, -0.05), bounds={"mass": (None, 11.0)}, depth=0)
    folds = graph.of_kind("fold")
    values = np.array([point.value for point in folds])
    assert len(folds) >= 6
    for point in folds:
        exact = fold_of(
            F,
            jacobian,
            lambda u: u,
            lambda u, v: (3.2 - 6.0 * u) * v,
            lambda v: v,
            point.u * (1.0 + 1e-5),
            point.value * (1.0 - 1e-5),
        )
        assert point.value == pytest.approx(exact, rel=5e-12)
        assert abs(point.value - exact) <= max(point.location_error, 1e-12)
    inside = values[1:-1]
    assert np.ptp(inside) > 0.02
    for end in (inside[inside < inside.mean()], inside[inside > inside.mean()]):
        assert np.ptp(end) < 0.01
