"""Coefficients beside those that other packages print, and by formulas derived for this test with derivatives in many digits.

With H(w) the centre manifold and N(w) the normal form, f(H(w)) = H(N(w)) order by order gives, for double multipliers with A q0 = m q0,
A q1 = m q1 + q0 and left vectors p1, p0 dual to them,

    m = 1    a = <p1, B(q0, q0)> / 2,   b = <p1, B(q0, q1)> + <p0, B(q0, q0)>
    m = -1   c = <p1, r> / 6,   d = <p1, C(q0, q0, q1) + 2 B(q0, h11) + B(q1, h20)> / 2 + <p0, r> / 2,   r = C(q0, q0, q0) + 3 B(q0, h20),
             (1 - A) h20 = B(q0, q0),   (1 - A) h11 = B(q0, q1) + h20

and at a cusp c = <p, C(q, q, q) + 3 B(q, h)> / 6 with A h = -B(q, q), <p, h> = 0.
"""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import coefficients, find
from tests.contvines.loci.systems import generalized_henon, generalized_henon_at

pytestmark = pytest.mark.slow


class Expansion:
    """Derivatives of a function of n numbers at a point, as multilinear forms."""

    def __init__(self, f, x):
        self.f, self.x, self.n, self.known = f, [mp.mpf(v) for v in x], len(x), {}

    def partial(self, orders):
        if orders not in self.known:
            self.known[orders] = [
                mp.diff(lambda *v, i=i: self.f(v)[i], tuple(self.x), orders) for i in range(self.n)
            ]
        return self.known[orders]

    def matrix(self):
        columns = [self.partial(tuple(int(i == j) for i in range(self.n))) for j in range(self.n)]
        return mp.matrix(columns).T

    def __call__(self, *vectors):
        total = mp.matrix(self.n, 1)
        for places in np.ndindex(*(self.n,) * len(vectors)):
            weight = mp.fprod(v[j] for v, j in zip(vectors, places))
            found = self.partial(tuple(places.count(j) for j in range(self.n)))
            total += weight * mp.matrix(found)
        return total


def dot(a, b):
    return mp.fsum(x * y for x, y in zip(a, b))


def null(A):
    """The unit vector with A v = 0, its largest entry positive."""
    u, _, v = mp.svd_r(A)
    x = v[A.rows - 1, :].T
    return x if max(x, key=abs) > 0 else -x


def chain(A, m):
    """q0, q1, p0, p1 of a double multiplier of a map of the plane."""
    N = A - m * mp.eye(2)  # q0 times a row across q0
    q0 = null(N)
    row = (q0.T * N).T
    q1 = row / dot(row, row)
    dual = mp.matrix([[q0[0], q1[0]], [q0[1], q1[1]]]) ** -1
    return q0, q1, dual[0, :].T, dual[1, :].T


def test_generalized_henon_at_its_double_multipliers():
    problem = generalized_henon()
    graph = cv.diagram(problem, over="be", within=(0.1, 1.5), depth=0)
    locus = cv.locus(graph["NS1"], over="al", within=(-1.2, 3.0), bounds=(0.1, 1.5))
    points = {point.kind: point for _, point in find(locus)}
    with mp.workdps(40):
        r = mp.mpf("-0.1")
        for kind, m in (("resonance-1-1", 1), ("resonance-1-2", -1)):
            x, be, al = generalized_henon_at(2 * m, r)
            point = points[kind]
            assert point.value == pytest.approx((float(be), float(al)), abs=1e-9)

            def f(v, be=be, al=al):
                return [v[1], al - be * v[0] - v[1] ** 2 + r * v[0] * v[1]]

            at = Expansion(f, [x, x])
            A = at.matrix()
            q0, q1, p0, p1 = chain(A, m)
            if m == 1:
                exact = {"a": dot(p1, at(q0, q0)) / 2, "b": dot(p1, at(q0, q1)) + dot(p0, at(q0, q0))}
            else:
                h20 = mp.lu_solve(mp.eye(2) - A, at(q0, q0))
                h11 = mp.lu_solve(mp.eye(2) - A, at(q0, q1) + h20)
                rest = at(q0, q0, q0) + 3 * at(q0, h20)
                other = at(q0, q0, q1) + 2 * at(q0, h11) + at(q1, h20)
                exact = {"c": dot(p1, rest) / 6, "d": (dot(p1, other) + dot(p0, rest)) / 2}
            found = coefficients(point)
            for name, value in exact.items():
                assert found[name] == pytest.approx(float(value), rel=1e-8), (kind, name)


def lorenz(u, F, T):
    """Extended Lorenz-84 (Shilnikov, Nicolis and Nicolis 1995; Kuznetsov, Meijer and van Veen 2004), parameters of BifurcationKit's test."""
    X, Y, Z, U = u
    return [
        -Y * Y - Z * Z - X / 4 + F / 4 - 0.987 * U * U,
        X * Y - X * Z - Y + 0.25,
        X * Y + X * Z - Z,
        -1.04 * U + 0.987 * U * X + T,
    ]


def double_zero(X, Y, Z, U, F, T):
    """The equations, and the two lowest coefficients of the characteristic polynomial."""
    g = mp.mpf("0.987")
    J = mp.matrix(
        [
            [-mp.mpf(1) / 4, -2 * Y, -2 * Z, -2 * g * U],
            [Y - Z, X - 1, -X, 0],
            [Y + Z, X, X - 1, 0],
            [g * U, 0, 0, g * X - mp.mpf("1.04")],
        ]
    )
    minors = [
        mp.det(mp.matrix([[J[i, j] for j in range(4) if j != k] for i in range(4) if i != k]))
        for k in range(4)
    ]
    return [
        -Y * Y - Z * Z - X / 4 + F / 4 - g * U * U,
        X * Y - X * Z - Y + mp.mpf(1) / 4,
        X * Y + X * Z - Z,
        -mp.mpf("1.04") * U + g * U * X + T,
        mp.det(J),
        mp.fsum(minors),
    ]


def test_extended_lorenz_84_as_printed():
    """Values of BifurcationKit's test test/hopf_codim_2/lorenz84.jl: a and b at a Bogdanov-Takens point that it solves for (T of that point, 0.02058724,
    is printed where it was detected, two per cent off), l2 and omega at a generalized Hopf point; its l2 is that of the rate of w, ours is divided by omega."""
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array(lorenz(u, p.F, p.T)),
        [2.9787, -0.038683, 0.0582327, -0.0210529],
        {"F": 3.0, "T": 0.04},
        parameter="F",
        spectrum="flow",
    )
    graph = cv.diagram(problem, over="F", within=(1.0, 3.0), depth=0)
    values = [s.value for s in (*graph.of_kind("hopf"), *graph.of_kind("fold"))]
    assert sorted(values) == pytest.approx([1.54664837, 1.61966, 2.46723, 2.85988], abs=2e-5)
    (fold,) = graph.of_kind("fold")
    points = [p for _, p in find(cv.locus(fold, over="T", within=(-0.1, 0.1), bounds=(1.0, 3.0)))]
    kinds = [p.kind for p in points]
    assert kinds == ["bogdanov-takens", "zero-hopf", "cusp", "zero-hopf", "bogdanov-takens"]
    for point in (points[0], points[-1]):
        with mp.workdps(30):
            exact = mp.findroot(double_zero, [mp.mpf(float(v)) for v in (*point.u, *point.value)])
            assert point.value == pytest.approx((float(exact[4]), float(exact[5])), abs=1e-11)
        found = {name: abs(value) for name, value in coefficients(point).items()}
        assert found == pytest.approx({"a": 0.2144233509273467, "b": 0.6065145518280868}, rel=1e-8)
    hopf = min(graph.of_kind("hopf"), key=lambda s: abs(s.value - 2.46723))
    points = [p for _, p in find(cv.locus(hopf, over="T", within=(-0.1, 0.1), bounds=(1.0, 3.0)))]
    assert {"generalized-hopf", "double-hopf"} <= {p.kind for p in points}
    bautin = [coefficients(p) for p in points if p.kind == "generalized-hopf"]
    nearest = min(bautin, key=lambda c: abs(c["omega"] - 0.6903636672622595))
    assert nearest["omega"] == pytest.approx(0.6903636672622595, abs=1e-5)
    assert nearest["l2"] * nearest["omega"] == pytest.approx(
        0.15555332623343107, abs=1e-3
    )  # their own tolerance
