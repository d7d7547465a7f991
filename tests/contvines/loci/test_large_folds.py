"""Folds of many unknowns in two parameters, against Newton's method on (F, F_u v, v.v - 1), written out here."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import contvines as cv

pytestmark = pytest.mark.slow


def rate(u, e):
    """exp(u / (1 + e u)) and its first and second derivative by u."""
    r = 1.0 + e * u
    value = np.exp(u / r)
    return value, value / r**2, value * (1.0 / r**4 - 2.0 * e / r**3)


def extended(line, u, p, e, v):
    """p of the fold of line u + p rate(u) near (u, p), with a null vector near v."""
    n = len(u)
    for _ in range(8):
        value, first, second = rate(u, e)
        A = line + sp.diags_array(p * first)
        rest = np.concatenate([line @ u + p * value, A @ v, [v @ v - 1.0]])
        rows = [
            [A, None, value[:, None]],
            [sp.diags_array(p * second * v), A, (first * v)[:, None]],
            [None, 2.0 * v[None, :], None],
        ]
        step = spsolve(sp.block_array(rows, format="csc"), -rest)
        u, v, p = u + step[:n], v + step[n : 2 * n], p + step[-1]
    return p


@pytest.mark.parametrize("n, sparse, accuracy", [(60, False, 1e-12), (600, True, 1e-11)])
def test_ignition_of_a_reaction_with_an_activation_energy(n, sparse, accuracy):
    h = 1.0 / (n + 1)
    line = sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsc() / h**2

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
        assert p == pytest.approx(extended(line, u, p, e, v / np.linalg.norm(v)), rel=accuracy)
