"""Demos of other packages, as they are printed, unscaled; every special point against an independent solve in mpmath.

The witness solves F = 0 together with det dF/du = 0 (folds) or the last but one Hurwitz determinant = 0 (Hopf points), from the
characteristic polynomial by Faddeev and LeVerrier, with derivatives of its own, in 40 digits. The numbers in the table only say
near which solution it begins, and are those that others print.
"""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv


def morris_lecar(u, current, m):
    """Rinzel and Ermentrout, Analysis of neural excitability and oscillations (1989); in mV and uA/cm^2."""
    v, w = u
    open_calcium = (1 + m.tanh((v + 1.2) / 18)) / 2
    open_potassium = (1 + m.tanh((v - 2) / 30)) / 2
    rate = 0.04 * m.cosh((v - 2) / 60)
    ionic = 2 * (v + 60) + 4.4 * open_calcium * (v - 120) + 8 * w * (v + 84)
    return [(current - ionic) / 20, rate * (open_potassium - w)]


def bazykin(u, alpha, m):
    """Bazykin's predator and prey, as in the tutorials of MatCont."""
    x, y = u
    eaten = x * y / (1 + alpha * x)
    return [x - eaten - 0.01 * x * x, -y + eaten - 0.1 * y * y]


def oxidation(u, q2, m):
    """Bykov, Yablonskii and Kim: oxidation of CO, as in the manuals of MatCont and BifurcationKit."""
    x, y, s = u
    z = 1 - x - y - s
    return [5 * z * z - 2 * x * x - 10 * x * y, q2 * z - 0.1 * y - 10 * x * y, 0.0675 * (z - 0.4 * s)]


def lorenz(u, r, m):
    """Lorenz's system: Hopf points at r = 470/19 (AUTO's demo lor)."""
    return [10 * (u[1] - u[0]), r * u[0] - u[1] - u[0] * u[2], u[0] * u[1] - 8 * u[2] / 3]


def two_prey(u, p, m):
    """AUTO's demo pp2."""
    return [3 * u[0] * (1 - u[0]) - u[0] * u[1] - p * (1 - m.exp(-5 * u[0])), -u[1] + 3 * u[0] * u[1]]


def reactor(u, p, m):
    """AUTO's demo ab."""
    reaction = p * (1 - u[0]) * m.exp(u[1])
    return [-u[0] + reaction, -3 * u[1] + 14 * reaction]


def nerve(u, current, m):
    """FitzHugh and Nagumo."""
    return [u[0] - u[0] ** 3 / 3 - u[1] + current, 0.08 * (u[0] + 0.7 - 0.8 * u[1])]


def squid(u, current, m):
    """Hodgkin and Huxley's axon, rest at 0 mV, as in XPPAUT's collection."""
    v, a, h, n = u
    rise = (
        0.1 * (25 - v) / (m.exp((25 - v) / 10) - 1),
        0.07 * m.exp(-v / 20),
        0.01 * (10 - v) / (m.exp((10 - v) / 10) - 1),
    )
    fall = 4 * m.exp(-v / 18), 1 / (m.exp((30 - v) / 10) + 1), 0.125 * m.exp(-v / 80)
    flow = 120 * a**3 * h * (v - 115) + 36 * n**4 * (v + 12) + 0.3 * (v - 10.6)
    return [current - flow, *(r * (1 - x) - f * x for r, f, x in zip(rise, fall, (a, h, n)))]


TABLE = [
    (morris_lecar, [-60.0, 0.015], 0.0, (0.0, 300.0), {"hopf": [93.86, 212.02]}),
    (bazykin, [1.5, 1.2], 0.2, (0.05, 1.2), {"hopf": [0.1146], "fold": [0.4426, 0.5474]}),
    (oxidation, [0.0011, 0.89, 0.062], 2.0, (0.5, 2.0), {"hopf": [1.041, 1.0516], "fold": [1.042, 1.0522]}),
    (
        two_prey,
        [0.0, 0.0],
        0.0,
        (0.0, 1.0),
        {"branch-point": [0.6, 0.8219], "fold": [0.8329], "hopf": [0.6716]},
    ),
    (reactor, [0.0, 0.0], 0.0, (0.0, 0.15), {"fold": [0.08893, 0.1057], "hopf": [0.1309]}),
    (nerve, [-1.2, -0.6], 0.0, (0.0, 2.0), {"hopf": [0.331, 1.419]}),
    (squid, [0.0, 0.05, 0.6, 0.32], 0.0, (0.0, 180.0), {"hopf": [9.78, 154.5]}),
]


def polynomial(matrix):
    """Coefficients of det(x - A), highest first, by Faddeev and LeVerrier."""
    n = matrix.rows
    coefficients, power = [mp.mpf(1)], mp.eye(n)
    for k in range(1, n + 1):
        product = matrix * power
        coefficients.append(-sum(product[i, i] for i in range(n)) / k)
        power = product + coefficients[-1] * mp.eye(n)
    return coefficients


def hurwitz(c):
    """The last but one Hurwitz determinant: zero where two eigenvalues have the sum zero."""
    n = len(c) - 1
    if n == 2:
        return c[1]
    entry = lambda i, j: c[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else mp.mpf(0)  # noqa: E731
    return mp.det(mp.matrix([[entry(i, j) for j in range(n - 1)] for i in range(n - 1)]))


def witness(f, kind, u, p):
    """The parameter value of a special point near (u, p)."""
    n = len(u)

    def system(*z):
        point, value = list(z[:n]), z[n]

        def entry(i, j):
            return mp.diff(lambda t: f([*point[:j], t, *point[j + 1 :]], value, mp)[i], point[j])

        c = polynomial(mp.matrix([[entry(i, j) for j in range(n)] for i in range(n)]))
        return [*f(point, value, mp), hurwitz(c) if kind == "hopf" else c[-1]]

    with mp.workdps(40):
        return float(
            mp.findroot(system, [*map(mp.mpf, map(float, u)), mp.mpf(float(p))], tol=1e-40, maxsteps=30)[n]
        )


@pytest.mark.parametrize(("f", "u", "p", "within", "expected"), TABLE, ids=[row[0].__name__ for row in TABLE])
def test_demo(f, u, p, within, expected):
    problem = cv.AlgebraicProblem(lambda u, p: f(u, p, np), u, p, spectrum="flow")
    graph = cv.diagram(problem, within=within, depth=2)
    found = {kind: sorted(point.value for point in graph.of_kind(kind)) for kind in expected}
    for kind, printed in expected.items():
        assert found[kind] == pytest.approx(printed, rel=2e-3), kind
    assert {point.kind for point in graph.special.values()} <= {*expected, "end"}
    for kind in ("fold", "hopf"):
        for point in graph.of_kind(kind):
            exact = witness(f, kind, point.u, point.value)
            assert point.value == pytest.approx(exact, rel=1e-10), (point.label, exact)


def test_lorenz():
    problem = cv.AlgebraicProblem(
        lambda u, r: lorenz(u, r, np), [0.0, 0.0, 0.0], 0.5, spectrum="flow", mirror=np.diag([-1, -1, 1])
    )
    graph = cv.diagram(problem, within=(0.0, 30.0))
    assert [point.value for point in graph.of_kind("hopf")] == pytest.approx([470.0 / 19.0], rel=1e-12)
