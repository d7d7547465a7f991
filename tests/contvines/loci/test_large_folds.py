"""Folds of many unknowns in two parameters, against Newton's method on (F, F_u v, v.v - 1), written out here."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import contvines as cv

pytestmark = pytest.mark.slow


def extended(line, u, p, e, v):
    """p and u of the fold of line u + p exp(u / (1 + e u)) near (u, p), with a null vector near v."""
    n = len(u)
    for _ in range(8):
        r = 1.0 + e * u
        rate = np.exp(u / r)
        first, second = rate / r**2, rate * (1.0 / r**4 - 2.0 * e / r**3)
        A = line + sp.diags_array(p * first)
        rest = np.concatenate([line @ u + p * rate, A @ v, [v @ v - 1.0]])
        matrix = sp.bmat(
            [
                [A, None, rate[:, None]],
                [sp.diags_array(p * second * v), A, (first * v)[:, None]],
                [None, 2.0 * v[None, :], None],
            ],
            format="csc",
        )
        step = spsolve(matrix, -rest)
        u, v, p = u + step[:n], v + step[n : 2 * n], p + step[-1]
    return p


@pytest.mark.parametrize("n, sparse, accuracy", [(60, False, 1e-12), (600, True, 1e-11)])
def test_ignition_of_a_reaction_with_an_activation_energy(n, sparse, accuracy):
    h = 1.0 / (n + 1)
    line = (
        sp.diags_array([np.ones(n - 1), -2.0 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]).tocsc() / h**2
    )
    dense = line.toarray()

    def jacobian(u, p):
        r = 1.0 + p.e * u
        slope = p.p * np.exp(u / r) / r**2
        return (line + sp.diags_array(slope)).tocsc() if sparse else dense + np.diag(slope)

    problem = cv.AlgebraicProblem(
        lambda u, p: line @ u + p.p * np.exp(u / (1.0 + p.e * u)),
        np.zeros(n),
        {"p": 0.0, "e": 0.0},
        jacobian=jacobian,
        derivative={
            "p": lambda u, p: np.exp(u / (1.0 + p.e * u)),
            "e": lambda u, p: -p.p * np.exp(u / (1.0 + p.e * u)) * (u / (1.0 + p.e * u)) ** 2,
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
