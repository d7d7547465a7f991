"""Charts of textbook systems whose loci and points of codimension two have closed forms: all of them are found, and no others.

Points at which a Lyapunov coefficient vanishes have none here: `test_flow_loci` has one in closed form, `normal_forms/test_printed_coefficients` one of the literature.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.codimension_two import coefficients, find
from tests.contvines.bifurcation.normal_forms.test_critical import Bend, circle, polar, square


def these(chart, expected):
    """The chart's points are those expected, {kind: [(p, q), ...]}, and no others but generalized Hopf points."""
    kinds = {point.kind for point in chart.points.values()} - {"generalized-hopf"}
    found = {kind: sorted(point.value for point in chart.of_kind(kind)) for kind in kinds}
    assert found == {
        kind: [pytest.approx(pair, abs=1e-9) for pair in sorted(places)] for kind, places in expected.items()
    }


def test_stirred_tank_ab():
    """Uppal, Ray and Poore's tank, demo ab of AUTO: u1' = -u1 + p1 (1 - u1) e^u2, u2' = -u2 + 14 p1 (1 - u1) e^u2 - p3 u2.

    Equilibria have u1 = k u2 with k = (1 + p3) / 14. Folds: u2 (1 - k u2) = 1; cusp: u2 = 2; trace zero: (1 + p3) (u2 - 1) (1 - k u2) = 1.
    """

    def f(u, p):
        rate = p.p1 * (1 - u[0]) * np.exp(u[1])
        return [-u[0] + rate, -u[1] + 14 * rate - p.p3 * u[1]]

    problem = cv.AlgebraicProblem(f, [0.0, 0.0], {"p1": 0.0, "p3": 2.0}, spectrum="flow")
    graph = cv.diagram(problem, over="p1", within=(0.0, 0.2), depth=0)
    chart = cv.chart(graph, over="p3", within=(0.6, 2.9), bounds=(0.01, 0.4), regions=False)
    for locus in chart.loci.values():
        (p1, p3), y = locus.values.T, locus.branch.points[:, 1]
        k = (1 + p3) / 14
        assert p1 == pytest.approx(k * y / (1 - k * y) * np.exp(-y), abs=1e-11)
        zero = y if locus.kind == "fold" else (1 + p3) * (y - 1)
        assert zero * (1 - k * y) == pytest.approx(1.0, abs=1e-9)
    assert len(chart.of_kind("generalized-hopf")) == 1
    # (1 + p3) (u2 - 1) = u2 on folds: u2^3 = 14 (u2 - 1)^2
    doubles = [((y - 1) * np.exp(-y), 1 / (y - 1)) for y in np.roots([1.0, -14.0, 28.0, -14.0])]
    doubles = [(p1, p3) for p1, p3 in doubles if 0.6 < p3 < 2.9]
    these(chart, {"cusp": [(np.exp(-2.0), 2.5)], "bogdanov-takens": doubles})
    for point in chart.of_kind("bogdanov-takens"):
        assert "omega" not in coefficients(point)  # a double zero has no frequency


def the_only_point(problem, label, span, bounds, slope):
    """Of the locus from a label on, along which p = slope(q): its kind, place and coefficients."""
    graph = cv.diagram(problem, over="p", within=(-0.4, 0.3), depth=0)
    locus = cv.locus(graph[label], over="q", within=span, bounds=bounds)
    p, q = locus.values.T
    assert p == pytest.approx(slope(q), abs=1e-11)
    ((_, point),) = find(locus)
    assert point.value == pytest.approx((0.0, 0.0), abs=1e-9)
    return point.kind, coefficients(point)


def test_generalized_period_doubling_at_a_known_place():
    """w -> -(1 + p + q^2) w + (q - p) w^3 + 0.7 w^5 in x = 1 + sinh w: c = q - p and the flip vanish together at p = q = 0."""

    def f(x, p):
        w = np.arcsinh(x - 1)
        return 1 + np.sinh(-(1 + p.p + p.q**2) * w + (p.q - p.p) * w**3 + 0.7 * w**5)

    problem = cv.MapProblem(f, [1.0], {"p": -0.2, "q": 0.3})
    kind, found = the_only_point(problem, "PD1", (-0.4, 0.5), (-0.6, 0.4), lambda q: -q * q)
    assert kind == "generalized-period-doubling"
    assert found == pytest.approx({"c": 0.0, "d": 0.7}, abs=1e-8)


@pytest.mark.slow
def test_chenciner_at_a_known_place():
    """z -> e^(0.9 i) z (1 + p + q/3 + (q - 2 p) r^2 - r^4) in bent coordinates: p = q = 0, second coefficient -1 (r^2 counts twice, squared 4)."""
    bend = Bend(2, 3)

    def f(x, p):
        z = bend.back(x)
        r = square(*z)
        m = 1 + p.p + p.q / 3 + (p.q - 2 * p.p) * r - r * r
        return np.array(bend(polar(*polar(*z, (m, 0.0)), circle(0.9))))

    problem = cv.MapProblem(f, [0.0, 0.0], {"p": -0.2, "q": 0.3})
    kind, found = the_only_point(problem, "NS1", (-0.5, 0.6), (-0.5, 0.4), lambda q: -q / 3)
    assert kind == "chenciner" and found["d2"] == pytest.approx(-4.0, abs=1e-7)


def turned(y, size, angle):
    return polar(*polar(*y, (size, 0.0)), circle(angle))


def flip_and_pair(y, a, b):
    return [-(1 + a) * y[0] + y[0] ** 3, *turned(y[1:], 1 + b + 0.2 * y[0] ** 2 - square(*y[1:]), 1.9)]


def fold_and_pair(y, a, b):
    pair = square(*y[1:])
    return [y[0] - a - y[0] ** 2 - pair / 2, *turned(y[1:], 1 + b + 0.4 * y[0] - pair, 1.9)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "g", "start", "label"),
    [
        ("flip-neimark-sacker", flip_and_pair, [0.0] * 3, "NS"),
        ("flip-neimark-sacker", flip_and_pair, [0.0] * 3, "PD"),
        # y0^2 = -a = 0.9 at p = -0.2, q = 0.3
        ("fold-neimark-sacker", fold_and_pair, [np.sqrt(0.9), 0.0, 0.0], "LP"),
    ],
)
def test_two_conditions_of_a_map_at_once(kind, g, start, label):
    """In sheared coordinates, a = p + q - 1 and b = p - 2 q + 1/2: both vanish at p = q = 1/2."""
    n = len(start)
    S = np.eye(n) + 0.3 * np.random.default_rng(7).standard_normal((n, n))
    back = np.linalg.inv(S)
    problem = cv.MapProblem(
        lambda u, p: S @ np.array(g(back @ u, p.p + p.q - 1, p.p - 2 * p.q + 0.5)),
        S @ start,
        {"p": -0.2, "q": 0.3},
    )
    graph = cv.diagram(problem, over="p", within=(-0.6, 1.2), depth=0)
    points = [point for point in graph.special.values() if point.label.startswith(label)]
    assert points
    for point in points:
        ((_, met),) = find(cv.locus(point, over="q", within=(0.0, 0.9), bounds=(-2.0, 2.0)))
        assert met.kind == kind and met.value == pytest.approx((0.5, 0.5), abs=1e-9)
