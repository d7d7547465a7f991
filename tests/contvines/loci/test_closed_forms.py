"""Charts of textbook systems whose loci and points of codimension two have closed forms: all of them are found, and no others.

Points at which a Lyapunov coefficient vanishes have none here: `test_flow_loci` has one in closed form, `normal_forms/test_printed_coefficients` one of the literature.
"""

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import coefficients, find
from tests.contvines.bifurcation.normal_forms.test_critical import Bend, polar


def chart_of(problem, over, within, second, span, bounds=None):
    graph = cv.diagram(problem, over=over, within=within, depth=0)
    return cv.chart(graph, over=second, within=span, bounds=bounds or within, regions=False)


def these(chart, expected, abs=1e-9):
    """The chart's points are those expected, {kind: [(p, q), ...]}, and no others but generalized Hopf points."""
    kinds = {point.kind for point in chart.points.values()} - {"generalized-hopf"}
    assert {kind: len(values) for kind, values in expected.items()} == {
        kind: len(chart.of_kind(kind)) for kind in kinds
    }
    for kind, values in expected.items():
        found = sorted(point.value for point in chart.of_kind(kind))
        for value, exact in zip(found, sorted(tuple(map(float, pair)) for pair in values)):
            assert value == pytest.approx(exact, abs=abs), kind


def test_stirred_tank_ab():
    """Uppal, Ray and Poore's tank, demo ab of AUTO: u1' = -u1 + p1 (1 - u1) e^u2, u2' = -u2 + 14 p1 (1 - u1) e^u2 - p3 u2.

    Equilibria have u1 = k u2 with k = (1 + p3) / 14. Folds: u2 (1 - k u2) = 1; cusp: u2 = 2; trace zero: (1 + p3) (u2 - 1) (1 - k u2) = 1.
    """

    def f(u, p):
        rate = p.p1 * (1 - u[0]) * np.exp(u[1])
        return np.array([-u[0] + rate, -u[1] + 14 * rate - p.p3 * u[1]])

    problem = cv.AlgebraicProblem(
        f,
        [0.0, 0.0],
        {"p1": 0.0, "p3": 2.0},
        parameter="p1",
        spectrum="flow",
    )
    graph = cv.diagram(problem, over="p1", within=(0.0, 0.2), depth=0)
    # printed by AUTO at p3 = 2
    assert sorted(p.value for p in graph.of_kind("fold")) == pytest.approx([0.0889318, 0.105739], abs=5e-7)
    assert graph.of_kind("hopf")[0].value == pytest.approx(0.130900, abs=5e-7)
    chart = cv.chart(graph, over="p3", within=(0.6, 2.9), bounds=(0.01, 0.4), regions=False)
    for locus in chart.loci.values():
        for (p1, p3), u in zip(locus.values, locus.branch.points):
            k, y = (1 + p3) / 14, u[1]
            assert p1 == pytest.approx(k * y / (1 - k * y) * np.exp(-y), abs=1e-11)
            zero = y * (1 - k * y) - 1 if locus.kind == "fold" else (1 + p3) * (y - 1) * (1 - k * y) - 1
            assert zero == pytest.approx(0.0, abs=1e-9)
    assert len(chart.of_kind("generalized-hopf")) == 1
    doubles = []  # (1 + p3) (u2 - 1) = u2 on folds: u2^3 = 14 (u2 - 1)^2
    for y in np.roots([1.0, -14.0, 28.0, -14.0]):
        exact = mp.findroot(lambda v: v**3 - 14 * (v - 1) ** 2, mp.mpf(y))
        p1, p3 = (exact - 1) * mp.exp(-exact), 1 / (exact - 1)
        doubles += [(p1, p3)] if 0.6 < p3 < 2.9 else []
    these(chart, {"cusp": [(np.exp(-2.0), 2.5)], "bogdanov-takens": doubles})


def test_fitzhugh_nagumo():
    """v' = v - v^3/3 - w + I, w' = (v + 0.7 - b w) / 4: folds v^2 = 1 - 1/b, Hopf v^2 = 1 - b/4 up to b = 2; cusp b = 1, v = 0."""

    def current(v, b):
        return (v + 0.7) / b - v + v**3 / 3

    v0, b0 = -1.4, 1.5
    problem = cv.AlgebraicProblem(
        lambda u, p: np.array([u[0] - u[0] ** 3 / 3 - u[1] + p.I, (u[0] + 0.7 - p.b * u[1]) / 4]),
        [v0, (v0 + 0.7) / b0],
        {"I": current(v0, b0), "b": b0},
        parameter="I",
        spectrum="flow",
    )
    chart = chart_of(problem, "I", (-1.0, 2.0), "b", (0.6, 3.0), (-2.0, 3.0))
    for locus in chart.loci.values():
        for (input_, b), u in zip(locus.values, locus.branch.points):
            assert input_ == pytest.approx(current(u[0], b), abs=1e-11)
            square = 1 - 1 / b if locus.kind == "fold" else 1 - b / 4
            assert u[0] ** 2 == pytest.approx(square, abs=1e-9)
    v = np.sqrt(0.5)
    these(chart, {"cusp": [(0.7, 1.0)], "bogdanov-takens": [(current(v, 2.0), 2.0), (current(-v, 2.0), 2.0)]})


def test_an_oscillator_that_is_locked_to_a_drive():
    """z' = z (1 - |z|^2) + i d z + K, s = |z|^2: s ((1 - s)^2 + d^2) = K^2; trace 2 - 4 s, determinant (1 - s) (1 - 3 s) + d^2.

    The determinant has a double zero in s at s = 2/3, d^2 = 1/3 (cusp), and vanishes with the trace at s = 1/2, d^2 = 1/4 (a double zero has no frequency).
    """

    def rates(x, p):
        growth = 1 - x[0] ** 2 - x[1] ** 2
        return np.array([growth * x[0] - p.d * x[1] + p.K, growth * x[1] + p.d * x[0]])

    problem = cv.AlgebraicProblem(rates, [1.2, 0.0], {"d": 0.0, "K": 0.52}, parameter="d", spectrum="flow")
    graph = cv.diagram(problem, within=(-0.6, 0.6), depth=0)
    points = list(cv.locus(graph.special["LP1"], over="K", within=(0.3, 1.0)).points.values())
    for kind, (d, K) in {"cusp": (np.sqrt(1 / 3), np.sqrt(8 / 27)), "bogdanov-takens": (0.5, 0.5)}.items():
        found = sorted(point.value for point in points if point.kind == kind)
        assert [abs(x) for pair in found for x in pair] == pytest.approx([d, K, d, K], abs=1e-9)
    for point in points:
        assert "omega" not in coefficients(point)


def test_generalized_period_doubling_at_a_known_place():
    """w -> -(1 + p + q^2) w + (q - p) w^3 + 0.7 w^5 in x = 1 + sinh w: c and the flip vanish together at p = q = 0."""

    def f(x, p):
        w = np.arcsinh(x - 1)
        return 1 + np.sinh(-(1 + p.p + p.q**2) * w + (p.q - p.p) * w**3 + 0.7 * w**5)

    problem = cv.MapProblem(f, [1.0], {"p": -0.2, "q": 0.3}, parameter="p")
    graph = cv.diagram(problem, over="p", within=(-0.5, 0.3), depth=0)
    locus = cv.locus(graph.special["PD1"], over="q", within=(-0.4, 0.5), bounds=(-0.6, 0.4))
    for p, q in locus.values:
        assert p == pytest.approx(-q * q, abs=1e-12)
    found = [(point.kind, *point.value, coefficients(point)) for _, point in find(locus)]
    # c = q - p = q + q^2 on the locus
    assert [kind for kind, *_ in found] == ["generalized-period-doubling"]
    assert found[0][1:3] == pytest.approx((0.0, 0.0), abs=1e-9)
    assert found[0][3] == pytest.approx({"c": 0.0, "d": 0.7}, abs=1e-8)


@pytest.mark.slow
def test_chenciner_at_a_known_place():
    """z -> e^(0.9 i) z (1 + p + q/3 + (q - 2 p) r^2 - r^4) in bent coordinates: p = q = 0, second coefficient -1 (r^2 counts twice, squared 4)."""
    bend = Bend(2, 3)

    def f(x, p):
        z = bend.back(x)
        r = z[0] * z[0] + z[1] * z[1]
        m = 1 + p.p + p.q / 3 + (p.q - 2 * p.p) * r - r * r
        return np.array(bend(polar(*polar(z[0], z[1], (m, 0.0)), (np.cos(0.9), np.sin(0.9)))))

    problem = cv.MapProblem(f, [0.0, 0.0], {"p": -0.2, "q": 0.3}, parameter="p")
    graph = cv.diagram(problem, over="p", within=(-0.4, 0.3), depth=0)
    locus = cv.locus(graph.special["NS1"], over="q", within=(-0.5, 0.6), bounds=(-0.5, 0.4))
    for p, q in locus.values:
        assert p == pytest.approx(-q / 3, abs=1e-11)
    found = [(point.kind, *point.value, coefficients(point)) for _, point in find(locus)]
    assert [kind for kind, *_ in found] == ["chenciner"]
    assert found[0][1:3] == pytest.approx((0.0, 0.0), abs=1e-9)
    assert found[0][3]["d2"] == pytest.approx(-4.0, abs=1e-7)


def mixed(g, n, seed):
    """The map or rates g(y, first, second) in sheared coordinates, with first = p + q - 1 and second = p - 2 q + 1/2; both vanish at p = q = 1/2."""
    S = np.eye(n) + 0.3 * np.random.default_rng(seed).standard_normal((n, n))
    back = np.linalg.inv(S)
    return lambda u, p: S @ np.array(g(back @ u, p.p + p.q - 1, p.p - 2 * p.q + 0.5)), S


def turned(y, size, angle):
    c, s = np.cos(angle), np.sin(angle)
    return [size * (c * y[0] - s * y[1]), size * (s * y[0] + c * y[1])]


def square(y):
    return y[0] * y[0] + y[1] * y[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "n", "g", "along"),
    [
        (
            "double-neimark-sacker",
            4,
            lambda y, a, b: [
                *turned(y[:2], 1 + a - square(y[:2]) + 0.3 * square(y[2:]), 0.8),
                *turned(y[2:], 1 + b + 0.2 * square(y[:2]) - square(y[2:]), 2.3),
            ],
            ("neimark-sacker",),
        ),
        (
            "flip-neimark-sacker",
            3,
            lambda y, a, b: [
                -(1 + a) * y[0] + y[0] ** 3,
                *turned(y[1:], 1 + b + 0.2 * y[0] ** 2 - square(y[1:]), 1.9),
            ],
            ("neimark-sacker", "period-doubling"),
        ),
        (
            "fold-neimark-sacker",
            3,
            lambda y, a, b: [
                y[0] - a - y[0] ** 2 - square(y[1:]) / 2,
                *turned(y[1:], 1 + b + 0.4 * y[0] - square(y[1:]), 1.9),
            ],
            ("fold",),
        ),
    ],
)
def test_two_conditions_of_a_map_at_once(kind, n, g, along):
    f, S = mixed(g, n, 7)
    start = np.zeros(n)
    if kind == "fold-neimark-sacker":  # y0^2 = -a = 0.9 at p = -0.2, q = 0.3
        start = S @ np.array([np.sqrt(0.9), 0.0, 0.0])
    problem = cv.MapProblem(f, start, {"p": -0.2, "q": 0.3}, parameter="p")
    graph = cv.diagram(problem, over="p", within=(-0.6, 1.2), depth=0)
    for name in along:
        points = graph.of_kind(name)
        assert points
        for point in points:
            locus = cv.locus(point, over="q", within=(0.0, 0.9), bounds=(-2.0, 2.0))
            found = [(met.kind, *met.value) for _, met in find(locus)]
            assert [which for which, *_ in found] == [kind]
            assert found[0][1:] == pytest.approx((0.5, 0.5), abs=1e-9)


def test_a_doubling_that_was_met_from_the_doubled_side():
    """The Henon map's 2-cycle was born at 4 a = 3 (1 - b)^2; the diagram begins on it and does not go beyond."""
    x, a, b = np.array([1.0, 0.0]), 0.6, 0.3
    for _ in range(400):
        x = np.array([1.0 - a * x[0] ** 2 + x[1], b * x[0]])
    other = np.array([1.0 - a * x[0] ** 2 + x[1], b * x[0]])
    problem = cv.MapProblem(
        lambda x, p: [1.0 - p.a * x[0] ** 2 + x[1], p.b * x[0]],
        [x, other],
        {"a": a, "b": b},
        parameter="a",
        cycle=2,
    )
    graph = cv.diagram(problem, within=(0.3, 0.7), depth=0)
    assert graph["PD1"].multipliers.real.max() == pytest.approx(1.0, abs=1e-6)  # of both iterations
    locus = cv.locus(graph["PD1"], over="b", within=(0.0, 0.6))
    assert locus.values[:, 0] == pytest.approx(0.75 * (1.0 - locus.values[:, 1]) ** 2, abs=1e-9)
