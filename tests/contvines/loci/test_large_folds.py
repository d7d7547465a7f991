"""Folds of many unknowns, in one parameter and in two, against Newton's method on (F, F_u v, v.v - 1), written out here."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import contvines as cv
from tests.contvines.problems.test_large import second_difference

pytestmark = pytest.mark.slow


def rate(u, e):
    """exp(u / (1 + e u)) and its first and second derivative by u."""
    r = 1.0 + e * u
    value = np.exp(u / r)
    return value, value / r**2, value * (1.0 / r**4 - 2.0 * e / r**3)


def fold_near(F, jacobian, derivatives, u, p, v):
    """p of the fold of F (u, p) near (u, p), v near its null vector; derivatives (u, p, v) are the diagonal of F_uu v, F_p and F_up v."""
    n, v = len(u), v / np.linalg.norm(v)
    for _ in range(8):
        A, (bent, first, second) = jacobian(u, p), derivatives(u, p, v)
        rest = np.concatenate([F(u, p), A @ v, [0.5 * (v @ v - 1.0)]])
        rows = [
            [A, None, first[:, None]],
            [sp.diags_array(bent), A, second[:, None]],
            [None, v[None, :], None],
        ]
        step = spsolve(sp.block_array(rows, format="csc"), -rest)
        u, v, p = u + step[:n], v + step[n : 2 * n], p + step[-1]
    return p


@pytest.mark.parametrize("n, sparse, accuracy", [(60, False, 1e-12), (600, True, 1e-11)])
def test_ignition_of_a_reaction_with_an_activation_energy(n, sparse, accuracy):
    h = 1.0 / (n + 1)
    line = second_difference(n) / h**2

    def jacobian(u, p):
        found = line + sp.diags_array(p.p * rate(u, p.e)[1])
        return found.tocsc() if sparse else found.toarray()

    problem = cv.AlgebraicProblem(
        lambda u, p: line @ u + p.p * rate(u, p.e)[0],
        np.zeros(n),
        {"p": 0.0, "e": 0.0},
        jacobian=jacobian,
        derivative={
            "p": lambda u, p: rate(u, p.e)[0],
            "e": lambda u, p: -p.p * u**2 * rate(u, p.e)[1],
        },
    )
    graph = cv.diagram(problem, within=(0.0, 6.0), bounds={f"u{n // 2}": (None, 2.0)}, depth=0)
    locus = cv.locus(graph["LP1"], over="e", within=(0.0, 0.15))
    assert locus.values[:, 1].max() == pytest.approx(0.15) and len(locus) > 10
    v = np.sin(np.pi * h * np.arange(1, n + 1))
    for i in np.linspace(0, len(locus) - 1, 5).astype(int):
        p, e = locus.values[i]
        u, _ = locus.problem.split(locus.branch.points[i])

        def derivatives(u, p, v, e=e):
            value, first, second = rate(u, e)
            return p * second * v, value, first * v

        exact = fold_near(
            lambda u, p, e=e: line @ u + p * rate(u, e)[0],
            lambda u, p, e=e: line + sp.diags_array(p * rate(u, e)[1]),
            derivatives,
            u,
            p,
            v,
        )
        assert p == pytest.approx(exact, rel=accuracy)


def test_localised_states_snake():
    """u' = r u - (1 + d^2/dx^2)^2 u + 1.6 u^2 - u^3 on half a line (Swift and Hohenberg), even about its middle: fold after fold, each to roundoff.

    The folds on either side come to lie at two values, the ends of the pinning region (Burke and Knobloch, Phys. Rev. E 73 (2006) 056211).
    """
    n, length = 120, 30.0
    x = np.linspace(0.0, length, n)
    inner = sp.identity(n) + second_difference(n, 2.0) / x[1] ** 2
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
        jacobian=jacobian,
        derivative=lambda u, r: u,
        outputs={"mass": lambda u, r: float(weights @ u**2)},
    )
    graph = cv.diagram(problem, within=(-0.5, -0.05), bounds={"mass": (None, 11.0)}, depth=0)
    folds = graph.of_kind("fold")
    assert len(folds) >= 6
    for point in folds:
        u, r = point.u * (1.0 + 1e-5), point.value * (1.0 - 1e-5)
        v = spsolve(jacobian(u, r), spsolve(jacobian(u, r), u))
        exact = fold_near(F, jacobian, lambda u, r, v: ((3.2 - 6.0 * u) * v, u, v), u, r, v)
        assert point.value == pytest.approx(exact, rel=5e-12)
        assert abs(point.value - exact) <= max(point.location_error, 1e-12)
    inside = np.array([point.value for point in folds[1:-1]])
    assert np.ptp(inside) > 0.02
    for end in (inside[inside < inside.mean()], inside[inside > inside.mean()]):
        assert np.ptp(end) < 0.01
