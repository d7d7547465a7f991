"""All seven coefficients of fold-flip points by formulas derived for this test, of drawn maps whose derivatives are known exactly.

f(x) = A x + B(x, x)/2 + C(x, x, x)/6 with A q0 = q0, A q1 = -q1 and left vectors p0, p1 dual to them. With H(w) the centre manifold and N(w)
the normal form of `contvines.bifurcation.normal_forms.critical`, f(H(w)) = H(N(w)) order by order gives

    w1^2/2     (A - 1) h20 = a q0 - B(q0, q0)              w1^3/6      c = <p0, C(q0, q0, q0) + 3 B(q0, h20)>
    w1 w2      (A + 1) h11 = e q1 - B(q0, q1)              w1 w2^2/2   d = <p0, C(q0, q1, q1) + B(q0, h02) + 2 B(q1, h11)>
    w2^2/2     (A - 1) h02 = b q0 - B(q1, q1)              w1^2 w2/2   f = <p1, C(q0, q0, q1) + B(q1, h20) + 2 B(q0, h11)>
                                                           w2^3/6      g = <p1, C(q1, q1, q1) + 3 B(q1, h02)>

with <p0, h20> = <p0, h02> = <p1, h11> = 0, so that the terms 3 a h20, b h20 - 2 e h02, (2 e - a) h11 and -3 b h11 on the right add nothing.
"""

from itertools import permutations

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms
from contvines.bifurcation.normal_forms.critical import normal_form


def bordered(matrix, side, column, row):
    """x with matrix x = side up to a multiple of the column, row.x = 0."""
    n = len(side)
    whole = np.block([[matrix, column[:, None]], [row[None, :], np.zeros((1, 1))]])
    return np.linalg.solve(whole, np.append(side, 0.0))[:n]


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("seed", [1, 2])
def test_all_coefficients_of_drawn_maps(n, seed):
    rng = np.random.default_rng(seed)
    S = np.eye(n) + 0.4 * rng.standard_normal((n, n))
    A = S @ np.diag([1.0, -1.0, 0.4, -0.3][:n]) @ np.linalg.inv(S)
    Q, K = rng.uniform(-1, 1, (n,) * 3), rng.uniform(-1, 1, (n,) * 4)
    Q = Q + Q.transpose(0, 2, 1)
    K = sum(K.transpose(0, *(1 + i for i in order)) for order in permutations(range(3)))

    def B(x, y):
        return np.einsum("ijk,j,k->i", Q, x, y)

    def C(x, y, z):
        return np.einsum("ijkl,j,k,l->i", K, x, y, z)

    q0, q1 = ((v / np.linalg.norm(v)) * np.sign(v[np.argmax(np.abs(v))]) for v in S.T[:2])
    p0, p1 = (row / (row @ q) for row, q in zip(np.linalg.inv(S), (q0, q1)))
    one = np.eye(n)
    a, b, e = p0 @ B(q0, q0), p0 @ B(q1, q1), p1 @ B(q0, q1)
    h20 = bordered(A - one, a * q0 - B(q0, q0), q0, p0)
    h02 = bordered(A - one, b * q0 - B(q1, q1), q0, p0)
    h11 = bordered(A + one, e * q1 - B(q0, q1), q1, p1)
    exact = {
        "a": a,
        "b": b,
        "c": p0 @ (C(q0, q0, q0) + 3 * B(q0, h20)),
        "d": p0 @ (C(q0, q1, q1) + B(q0, h02) + 2 * B(q1, h11)),
        "e": e,
        "f": p1 @ (C(q0, q0, q1) + B(q1, h20) + 2 * B(q0, h11)),
        "g": p1 @ (C(q1, q1, q1) + 3 * B(q1, h02)),
    }
    problem = cv.MapProblem(lambda x, p: A @ x + B(x, x) / 2 + C(x, x, x) / 6, np.zeros(n), 0.0)
    found = normal_form("fold-flip", Forms(problem, np.zeros(n), 0.0), [])
    assert found == pytest.approx(exact, rel=1e-9, abs=1e-9)
