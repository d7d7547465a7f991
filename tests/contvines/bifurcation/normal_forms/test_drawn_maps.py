"""Normal forms of drawn maps whose derivatives are known exactly, by formulas derived for this test.

f(x) = A x + B(x, x)/2 + C(x, x, x)/6. With H(w) the centre manifold and N(w) the normal form of
`contvines.bifurcation.normal_forms.critical`, f(H(w)) = H(N(w)) order by order gives what the tests say.
"""

from itertools import permutations

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms
from contvines.bifurcation.normal_forms.critical import normal_form


class Drawn:
    """A has the multipliers 1 and -1 for q0, q1, to which p0, p1 are dual; the others are 0.4 and -0.3.

    q0 and q1 have length one, their largest entries are positive.
    """

    def __init__(self, n, seed):
        rng = np.random.default_rng(seed)
        S = np.eye(n) + 0.4 * rng.standard_normal((n, n))
        for v in S.T[:2]:
            v /= np.linalg.norm(v) * np.sign(v[np.argmax(np.abs(v))])
        J = np.diag([1.0, -1.0, 0.4, -0.3][:n])
        self.one, self.A = np.eye(n), S @ J @ np.linalg.inv(S)
        self.critical = (*S.T[:2], *np.linalg.inv(S)[:2])
        self.Q, K = rng.uniform(-1, 1, (n,) * 3), rng.uniform(-1, 1, (n,) * 4)
        self.Q = self.Q + self.Q.transpose(0, 2, 1)
        self.K = sum(K.transpose(0, *(1 + i for i in order)) for order in permutations(range(3)))

    def B(self, x, y):
        return np.einsum("ijk,j,k->i", self.Q, x, y)

    def C(self, x, y, z):
        return np.einsum("ijkl,j,k,l->i", self.K, x, y, z)

    def normal_form(self):
        origin = np.zeros(len(self.A))
        problem = cv.MapProblem(lambda x, p: self.A @ x + self.B(x, x) / 2 + self.C(x, x, x) / 6, origin, 0.0)
        return normal_form("fold-flip", Forms(problem, origin, 0.0), [])


def bordered(matrix, side, column, row):
    """x with matrix x = side up to a multiple of the column, row.x = 0."""
    n = len(side)
    whole = np.block([[matrix, column[:, None]], [row[None, :], np.zeros((1, 1))]])
    return np.linalg.solve(whole, np.append(side, 0.0))[:n]


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("seed", [1, 2])
def test_fold_flip(n, seed):
    """
    w1^2/2     (A - 1) h20 = a q0 - B(q0, q0)              w1^3/6      c = <p0, C(q0, q0, q0) + 3 B(q0, h20)>
    w1 w2      (A + 1) h11 = e q1 - B(q0, q1)              w1 w2^2/2   d = <p0, C(q0, q1, q1) + B(q0, h02) + 2 B(q1, h11)>
    w2^2/2     (A - 1) h02 = b q0 - B(q1, q1)              w1^2 w2/2   f = <p1, C(q0, q0, q1) + B(q1, h20) + 2 B(q0, h11)>
                                                           w2^3/6      g = <p1, C(q1, q1, q1) + 3 B(q1, h02)>

    with <p0, h20> = <p0, h02> = <p1, h11> = 0, so that the terms 3 a h20, b h20 - 2 e h02, (2 e - a) h11 and -3 b h11 on the right add nothing.
    """
    m = Drawn(n, seed)
    A, B, C, (q0, q1, p0, p1) = m.A, m.B, m.C, m.critical
    a, b, e = p0 @ B(q0, q0), p0 @ B(q1, q1), p1 @ B(q0, q1)
    h20 = bordered(A - m.one, a * q0 - B(q0, q0), q0, p0)
    h02 = bordered(A - m.one, b * q0 - B(q1, q1), q0, p0)
    h11 = bordered(A + m.one, e * q1 - B(q0, q1), q1, p1)
    c, d = p0 @ (C(q0, q0, q0) + 3 * B(q0, h20)), p0 @ (C(q0, q1, q1) + B(q0, h02) + 2 * B(q1, h11))
    f, g = p1 @ (C(q0, q0, q1) + B(q1, h20) + 2 * B(q0, h11)), p1 @ (C(q1, q1, q1) + 3 * B(q1, h02))
    exact = {"a": a, "b": b, "c": c, "d": d, "e": e, "f": f, "g": g}
    assert m.normal_form() == pytest.approx(exact, rel=1e-9, abs=1e-9)
