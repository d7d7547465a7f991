"""Coefficients at points of codimension two of systems of the literature, by the textbook's formulas with exact derivatives in many digits.

Source of the formulas: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 8.4 and 8.7 (Bogdanov-Takens, Bautin), 9.5 and 9.6 (resonances
1:3, 1:4); the locations are solved anew in 30 digits from the conditions themselves.
"""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.coefficients_at import coefficients

pytestmark = pytest.mark.slow


class Planar:
    """Derivatives of a function of the plane at a point, as multilinear forms, by mpmath's numerical differentiation in many digits."""

    def __init__(self, f, x):
        self.f, self.x, self.known = f, x, {}

    def partial(self, component, orders):
        key = (component, orders)
        if key not in self.known:
            self.known[key] = mp.diff(lambda *v: self.f(v)[component], tuple(self.x), orders)
        return self.known[key]

    def matrix(self):
        return mp.matrix([[self.partial(i, (1, 0)), self.partial(i, (0, 1))] for i in range(2)])

    def form(self, *vectors):
        """B(a, b) or C(a, b, c)."""
        total = []
        for i in range(2):
            value = mp.mpc(0)
            for places in np.ndindex(*(2,) * len(vectors)):
                weight = mp.mpc(1)
                for vector, place in zip(vectors, places):
                    weight *= vector[place]
                value += weight * self.partial(i, (places.count(0), places.count(1)))
            total.append(value)
        return mp.matrix(total)


def dot(a, b):
    return sum(mp.conj(x) * y for x, y in zip(a, b))


def conj(a):
    return mp.matrix([mp.conj(x) for x in a])


def eigen(A, m):
    """q of unit length with A q = m q, and p with A^T p = conj(m) p, <p, q> = 1."""
    q = mp.matrix([A[0, 1], m - A[0, 0]])
    q /= mp.sqrt(mp.re(dot(q, q)))
    p = mp.matrix([A[1, 0], mp.conj(m) - A[0, 0]])
    return q, p / mp.conj(dot(p, q))


def resonance(f, x, angle):
    """Coefficients at the resonance 1:3 or 1:4 of a map of the plane."""
    at = Planar(f, x)
    A, one = at.matrix(), mp.eye(2)
    m = mp.e ** (1j * angle)
    q, p = eigen(A, m)
    h11 = mp.lu_solve(one - A, at.form(q, conj(q)))
    if abs(angle - mp.pi / 2) < 1e-3:
        h20 = mp.lu_solve(m * m * one - A, at.form(q, q))
        total = at.form(q, q, conj(q)) + 2 * at.form(q, h11) + at.form(conj(q), h20)
        other = at.form(conj(q), conj(q), conj(q)) + 3 * at.form(conj(q), conj(h20))
        c, d = dot(p, total) / 2, dot(p, other) / 6
        A0 = -1j * c / abs(d)
        return {"A_re": mp.re(A0), "A_im": mp.im(A0)}
    b = dot(p, at.form(conj(q), conj(q))) / 2
    # m^2 is the other multiplier: (m^2 - A) h20 = B(q, q) - 2 conj(b) conj(q), without a part along conj(q)
    side = at.form(q, q) - 2 * mp.conj(b) * conj(q)
    matrix, right = mp.matrix(3), mp.matrix(3, 1)
    for i in range(2):
        for j in range(2):
            matrix[i, j] = (m * m if i == j else 0) - A[i, j]
        matrix[i, 2], matrix[2, i], right[i] = mp.conj(q[i]), p[i], side[i]
    h20 = mp.lu_solve(matrix, right)[:2]
    h20 = mp.matrix([h20[0], h20[1]])
    c = dot(p, at.form(q, q, conj(q)) + 2 * at.form(q, h11) + at.form(conj(q), h20)) / 2
    return {"b": abs(b), "a": (mp.re(c / m) / abs(b) ** 2 - 1) / 3}


def agree(point, exact):
    found = coefficients(point)
    for name, value in exact.items():
        assert found[name] == pytest.approx(float(value), rel=1e-8, abs=1e-9), name


def bazykin(v, al, de):
    x, y = v
    eaten = x * y / (1 + al * x)
    return [x - eaten - x * x / 100, -y + eaten - de * y * y]


def lyapunov(f, x):
    """l1 of an equilibrium of the plane with eigenvalues +-i omega, with a critical vector of unit length."""
    at = Planar(f, x)
    A = at.matrix()
    omega = mp.sqrt(mp.det(A))
    q, p = eigen(A, 1j * omega)
    total = dot(p, at.form(q, q, conj(q))) - 2 * dot(p, at.form(q, mp.lu_solve(A, at.form(q, conj(q)))))
    total += dot(p, at.form(conj(q), mp.lu_solve(2j * omega * mp.eye(2) - A, at.form(q, q))))
    return mp.re(total) / (2 * omega)


def test_bazykin_predator_and_prey_chart():
    # Bazykin 1985; Kuznetsov, example 8.3 with epsilon = 0.01, gamma = 1
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array(
            [
                u[0] - u[0] * u[1] / (1 + p.al * u[0]) - 0.01 * u[0] ** 2,
                -u[1] + u[0] * u[1] / (1 + p.al * u[0]) - p.de * u[1] ** 2,
            ]
        ),
        [2.0, 1.6],
        {"al": 0.3, "de": 0.2},
        parameter="de",
        spectrum="flow",
    )
    graph = cv.diagram(problem, over="de", within=(0.02, 0.6), depth=0)
    chart = cv.chart(graph, over="al", within=(0.05, 0.9), bounds=(0.005, 1.0), regions=False)
    assert chart.of_kind("bogdanov-takens")
    with mp.workdps(30):
        for point in chart.of_kind("bogdanov-takens"):

            def double(x, y, de, al):
                A = Planar(lambda v: bazykin(v, al, de), [x, y]).matrix()
                return [*bazykin([x, y], al, de), mp.det(A), A[0, 0] + A[1, 1]]

            x, y, de, al = mp.findroot(double, [mp.mpf(float(c)) for c in (*point.u, *point.value)])
            assert (float(de), float(al)) == pytest.approx(point.value, abs=1e-9)
            at = Planar(lambda v, al=al, de=de: bazykin(v, al, de), [x, y])
            A = at.matrix()
            q0 = mp.matrix([A[0, 1], -A[0, 0]])
            q0 /= mp.sqrt(mp.re(dot(q0, q0)))
            if max(q0, key=abs) < 0:
                q0 = -q0
            q1 = mp.lu_solve(A + q0 * q0.T, q0)
            q1 /= 1 - dot(q0, q1)  # A q1 = q0; a multiple of q0 may be added, on which nothing depends
            basis = mp.matrix([[q0[0], q1[0]], [q0[1], q1[1]]]) ** -1
            p0, p1 = ([basis[i, 0], basis[i, 1]] for i in range(2))
            a = dot(p1, at.form(q0, q0)) / 2
            b = dot(p0, at.form(q0, q0)) + dot(p1, at.form(q0, q1))
            agree(point, {"a": mp.re(a), "b": mp.re(b)})
        for point in chart.of_kind("generalized-hopf"):

            def flat(x, y, de, al):
                def f(v):
                    return bazykin(v, al, de)

                A = Planar(f, [x, y]).matrix()
                return [*f([x, y]), A[0, 0] + A[1, 1], lyapunov(f, [x, y])]

            found = mp.findroot(flat, [mp.mpf(float(c)) for c in (*point.u, *point.value)], tol=1e-18)
            assert (float(found[2]), float(found[3])) == pytest.approx(point.value, abs=1e-9)
