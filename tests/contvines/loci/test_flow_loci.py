"""Loci and charts of flows against closed forms.

A limit cycle r = 1 with angular speed 1, beside which further states z obey an equation of their own, z' = g(z): cycles are then equilibria
of g, their multipliers exp(2 pi lambda) with the eigenvalues lambda of these, or minus that where z lives on a band that is twisted once.
"""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contvines as cv
from contvines.loci.adaptive import AdaptiveLocus
from contvines.problems.abilities import Adaptive
from tests.contvines.flows.shooting import nerve, unit_circle
from tests.contvines.loci.systems import BAZYKIN_DOUBLE_ZERO, bautin, bazykin

pytestmark = pytest.mark.slow


def spiral(z, growth, turn, inward=1.0):
    """z' = (growth + i turn) z - inward z |z|^2."""
    rate = growth - inward * (z[0] ** 2 + z[1] ** 2)
    return [rate * z[0] - turn * z[1], turn * z[0] + rate * z[1]]


def ring(x):
    return spiral(x, 1.0, 1.0)


def cycle(flow, states):
    """The orbit whose states are given as functions of the phase."""
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    return flow.cycle(t, np.column_stack([part + 0.0 * t for part in states(t)]))


def canard(e, low, high):
    """Current at which the slow manifolds meet above the fold x = -1, by simulation forwards and backwards."""

    def passes(t, y):
        return y[0] + 1.0

    passes.terminal = True

    def height(current, start, sign):
        begin, p = [start, start - start**3 / 3 + current], SimpleNamespace(current=current, e=e)
        found = solve_ivp(
            lambda t, x: sign * np.array(nerve(x, p)),
            (0, 1e4),
            begin,
            "DOP853",
            rtol=1e-13,
            atol=1e-14,
            events=passes,
        )
        return found.y_events[0][0][1]

    return brentq(lambda i: height(i, -1.6, 1.0) - height(i, -0.1, -1.0), low, high, xtol=1e-14)


def test_folds_of_cycles_go_on_through_a_canard_explosion():
    """Where the equations are singular to rounding along the whole explosion. By symmetry, (x, y, I) to -(x, y, I), both folds have the sum 7/4 of currents."""
    flow = cv.FlowProblem(nerve, [-1.2, -0.6], {"current": 0.0, "e": 0.08})
    graph = cv.diagram(flow, over="current", within=(0.0, 2.0), depth=1, settings={"max_branches": 2})
    left, right = (cv.locus(graph[label], over="e", within=(0.02, 0.5)) for label in ("LP1", "LP2"))
    assert isinstance(left.problem, Adaptive)  # the mesh and the phase follow the cycles
    for locus in (left, right):
        assert [locus.values[0, 1], locus.values[-1, 1]] == [0.02, 0.5]
        assert len(locus) < 100
        assert not locus.points
    for end in (0, -1):
        assert left.values[end, 0] + right.values[end, 0] == pytest.approx(1.75, abs=1e-9)
    # of relaxation oscillations the fold is within exp(-c/e) of the canard
    assert left.values[0, 0] == pytest.approx(canard(0.02, 0.299, 0.301), abs=1e-10)


def test_folds_of_cycles_of_a_nerve_end_at_its_generalized_hopf_point():
    """At x = -1/2: with f the cubic and b = 0.8 the first Lyapunov coefficient is zero where the third derivative is -b / (1 - e b^2) times the second one's square."""
    flow = cv.FlowProblem(nerve, [-1.2, -0.6], {"current": 0.70, "e": 0.9374})
    graph = cv.diagram(flow, over="current", within=(0.70, 0.712), depth=1, settings={"max_branches": 2})
    # the only one, far beyond what is known of both
    ((hopf,), (fold,)) = graph.of_kind("hopf"), graph.of_kind("fold")
    assert hopf.value - fold.value > 100.0 * (hopf.location_error + fold.location_error)
    assert not graph.unresolved
    locus = cv.locus(fold, over="e", within=(0.9373, 0.938))
    assert locus.ended[1] == "the motion becomes an equilibrium, at current = 0.7083333333, e = 0.9375"
    (point,) = locus.points.values()
    assert point.kind == "generalized-hopf"
    assert point.value == pytest.approx((17 / 24, 15 / 16), abs=1e-11)


def test_a_hopf_point_met_by_cycles_is_followed_as_that_of_the_equilibrium():
    """1 - v^2 = 0.8 e at rest with w = (v + 0.7) / 0.8 and I = w - v + v^3 / 3."""
    flow = cv.FlowProblem(nerve, [-1.2, -0.6], {"current": 0.0, "e": 0.08})
    graph = cv.diagram(flow.attractor(current=0.8), over="current", within=(0.0, 1.0), depth=0)
    locus = cv.locus(graph["HB1"], over="e", within=(0.04, 0.12))
    v = -np.sqrt(1.0 - 0.8 * locus.values[:, 1])
    assert locus.values[:, 0] == pytest.approx((v + 0.7) / 0.8 - v + v**3 / 3.0, abs=1e-9)
    assert locus.values[[0, -1], 1] == pytest.approx([0.04, 0.12])


def test_a_chart_finds_the_folds_of_cycles_and_names_what_is_stable(tmp_path):
    flow = cv.FlowProblem(bautin, [0.0, 0.0], {"mu": -1.0, "b": -0.5})
    graph = cv.diagram(flow, over="mu", within=(-1, 1))
    assert not graph.of_kind("fold")
    chart = cv.chart(graph, "b", (-1.5, 2.0))
    assert {locus.kind for locus in chart.loci.values()} == {"hopf", "fold"}
    (point,) = chart.points.values()
    assert (point.kind, len(point.on)) == ("generalized-hopf", 2)
    assert len(chart.regions) == 3
    for region in chart.regions:
        mu, b = region.at
        both = mu <= 0 < b and 4 * mu > -(b**2)
        wanted = ["cycle"] if mu > 0 else ["cycle", "equilibrium"] if both else ["equilibrium"]
        assert sorted(region.words) == wanted
        assert not region.others
    chart.save(tmp_path / "bautin.vines")
    (folds,) = (each for each in cv.load(tmp_path / "bautin.vines").loci.values() if each.kind == "fold")
    mu, b = folds.values.T
    assert mu == pytest.approx(-(b**2) / 4, abs=1e-10) and b.max() == 2.0
    assert "the motion becomes an equilibrium, at mu = 0, b = 0" in folds.ended
    assert point.value == pytest.approx((0.0, 0.0), abs=1e-9)


def test_loci_of_cycles_meet_at_a_resonance():
    """Bogdanov and Takens beside a ring: folds of cycles b1 = b2^2 / 4, Neimark-Sacker points b1 = 0, b2 < 0, and a resonance 1:1."""

    def rates(x, p):
        return [*ring(x), x[3], p.b1 + p.b2 * x[2] + x[2] ** 2 - x[2] * x[3]]

    flow = cv.FlowProblem(rates, [1.0, 0, 0, 0], {"b1": -0.05, "b2": -0.3}, scale=1.0)
    orbit = cycle(flow, lambda t: [np.cos(t), np.sin(t), (0.3 - np.sqrt(0.29)) / 2, 0.0])
    graph = cv.diagram(orbit, over="b1", within=(-0.2, 0.2), depth=0)
    assert graph["NS1"].value == pytest.approx(0.0, abs=1e-11)
    fold, pair = (cv.locus(graph[label], over="b2", within=(-0.6, 0.4)) for label in ("LP1", "NS1"))
    p, q = fold.values.T
    assert np.abs(p - q**2 / 4).max() < 1e-10
    p, q = pair.values.T
    assert np.abs(p).max() < 1e-10
    assert q.max() == pytest.approx(0.0, abs=1e-6)
    (point,) = fold.points.values()
    assert point.kind == "resonance-1-1"
    assert point.value == pytest.approx((0.0, 0.0), abs=1e-10)
    # the flow of w1' = w2, w2' = a w1^2 + b w1 w2 for the time 2 pi, in steps of which w2 is counted
    assert point.coefficients["a"] == pytest.approx(-4 * np.pi**2, rel=1e-6)


def test_homoclinic_orbits_begin_at_a_bogdanov_takens_point():
    """b2 = e^2 (10/7 + 288/2401 e^2 + O(e^4)) where b1 = -4 e^4 (Al-Hdaibat, Govaerts, Kuznetsov and Meijer, SIAM J. Appl. Dyn. Syst. 15 (2016) 952)."""

    def takens(x, p):
        return [x[1], p.b1 + p.b2 * x[1] + x[0] ** 2 + x[0] * x[1]]

    flow = cv.FlowProblem(takens, [-0.2, 0.0], {"b1": -0.04, "b2": 0.1})
    graph = cv.diagram(flow, over="b1", within=(-0.3, 0.1))
    span = {"over": "b2", "within": (-0.3, 0.6)}
    (point,) = cv.locus(graph["HB1"], **span).points.values()
    locus, met = cv.locus(point, **span), cv.locus(graph["HC1"], **span, period=120.0)
    for values, least in ((locus.values, 0.005), (met.values, 0.02)):
        b1, b2 = values[values[:, 1] > least].T
        fourth = -b1 / 4.0
        assert len(b1) > 20
        assert (np.abs(b2 / np.sqrt(fourth) - 10 / 7 - 288 / 2401 * np.sqrt(fourth)) < 0.01 * fourth).all()
    assert all(met.orbit(i).period == pytest.approx(120.0) for i in range(0, len(met), 20))
    assert met.values[:, 1].min() < 0.01 and "too short" in met.ended[0]
    longer = cv.locus(point, **span, period=400.0)
    assert longer.orbit(0).period == pytest.approx(400.0)
    assert longer.values[:, 1].min() < 0.5 * locus.values[:, 1].min()
    for source, over, period, said in (
        (point, "b1", None, "lies on a locus over"),
        (graph["HB1"], "b2", 50.0, "homoclinic"),
    ):
        with pytest.raises(ValueError, match=said):
            cv.locus(source, over=over, within=(-0.3, 0.6), period=period)


def test_a_homoclinic_locus_from_a_diagram_and_from_a_bogdanov_takens_point_is_one():
    flow = cv.FlowProblem(bazykin, [20.0, 5.5], {"alpha": 0.4, "delta": 0.15})
    graph = cv.diagram(flow, over="alpha", within=(0.1, 1.0))
    chart = cv.chart(graph, "delta", (0.05, 0.5), regions=False)
    (locus,) = (locus for locus in chart.loci.values() if locus.kind == "homoclinic")
    (point,) = chart.points.values()
    assert point.kind == "bogdanov-takens" and set(point.on) == {"HB1", "LP2", locus.label}
    assert point.value == pytest.approx(BAZYKIN_DOUBLE_ZERO, abs=1e-9)
    assert np.abs(locus.values - point.value).max(axis=1).min() < 1e-3


def twisted(x, z, growth, other, turn=1.0):
    """A band that turns half round while the ring turns once, at some rate: along it w' = growth w - w |z|^2, across it at the rate `other`.

    Multipliers are -exp(2 pi growth) and -exp(2 pi other).
    """
    radius = np.sqrt(x[0] ** 2 + x[1] ** 2)
    c, s = x[0] / radius, x[1] / radius
    mean, half, inward = 0.5 * (growth + other), 0.5 * (growth - other), z[0] ** 2 + z[1] ** 2
    return [
        (mean + half * c - inward) * z[0] + (half * s - 0.5 * turn) * z[1],
        (half * s + 0.5 * turn) * z[0] + (mean - half * c - inward) * z[1],
    ]


def flip_and_pair(x, p):
    """Beside the ring: multipliers -exp(2 pi a), and a pair of modulus exp(2 pi (b + a / 2))."""
    return [*ring(x), *twisted(x, x[2:], p.a, -0.4), *spiral(x[4:], p.b + 0.5 * p.a, 0.7)]


def two_pairs(x, p):
    """Beside the ring: pairs of modulus exp(2 pi a) and exp(2 pi (b - a))."""
    return [*ring(x), *spiral(x[2:4], p.a, 0.2), *spiral(x[4:], p.b - p.a, 0.7)]


def fold_and_flip(x, p):
    """Cycles s = r^2 - 1 = +-sqrt a, with a multiplier -exp(2 pi (b + s))."""
    s = x[0] ** 2 + x[1] ** 2 - 1.0
    return [*spiral(x, p.a - s * s, 1.0, 0.0), *twisted(x, x[2:], p.b + s, -0.4)]


@pytest.mark.parametrize(
    ("f", "label", "kind", "p11"),
    [
        (flip_and_pair, "PD1", "flip-neimark-sacker", -2 * np.pi),
        (two_pairs, "NS1", "double-neimark-sacker", -4 * np.pi),
    ],
)
def test_two_things_at_once_beside_a_ring(f, label, kind, p11):
    flow = cv.FlowProblem(f, [1.0, 0, 0, 0, 0, 0], {"a": -0.3, "b": 0.12}, scale=1.0)
    graph = cv.diagram(flow.cycle(*unit_circle(6)), over="a", within=(-0.5, 0.05), depth=0)
    locus = cv.locus(graph[label], over="b", within=(-0.2, 0.2))
    (point,) = (point for point in locus.points.values() if point.kind == kind)
    assert np.abs(point.value).max() < min(point.error, 1e-9)
    # amplitudes that fall by their cubes for the time 2 pi, of pairs (of length one as real vectors) twice that, and do not see each other
    for name, value in {"p11": p11, "p12": 0.0, "p21": 0.0, "p22": -4 * np.pi}.items():
        assert point.coefficients[name] == pytest.approx(value, abs=1e-8)


def test_period_doublings_touch_the_folds_of_cycles():
    flow = cv.FlowProblem(fold_and_flip, [1.0, 0, 0, 0], {"a": 0.25, "b": -0.2}, scale=1.0)
    orbit = cycle(flow, lambda t: [np.sqrt(1.5) * np.cos(t), np.sqrt(1.5) * np.sin(t), 0.0, 0.0])
    graph = cv.diagram(orbit, over="a", within=(-0.5, 0.5), depth=0)
    assert graph["PD1"].value == pytest.approx(0.04, abs=1e-10)
    for label in ("PD1", "LP1"):
        locus = cv.locus(graph[label], over="b", within=(-0.3, 0.1))
        p, q = locus.values.T
        assert np.abs(p - (q**2 if label == "PD1" else 0.0)).max() < 1e-10
        (point,) = locus.points.values()
        assert point.kind == "fold-flip"
        assert np.abs(point.value).max() < min(point.error, 1e-9)


def test_period_doublings_go_on_where_the_mesh_becomes_too_coarse():
    """The ring turns ever slower at one place, at the rate 1 + q cos; along the band w grows at the rate b - q^2. Nothing is followed twice."""

    def rates(x, p):
        turn = 1 + p.q * x[0] / np.hypot(x[0], x[1])
        return [*spiral(x, 1.0, turn), *twisted(x, x[2:], p.b - p.q**2, -0.4, turn)]

    flow = cv.FlowProblem(rates, [1.0, 0, 0, 0], {"b": -0.1, "q": 0.0}, scale=1.0)
    doubling = cv.diagram(flow.cycle(*unit_circle(4)), over="b", within=(-0.2, 0.2), depth=0)["PD1"]
    numbers = []
    locus = cv.locus(
        doubling, over="q", within=(-0.1, 0.99), progress=lambda label, points, value: numbers.append(points)
    )
    assert sum(after < before for before, after in pairwise(numbers)) <= 1  # one side, then the other
    assert isinstance(locus.problem, AdaptiveLocus)
    assert locus.problem.mesh.intervals > len(doubling.u) // 17  # unknowns for each interval at the start
    b, q = locus.values.T
    assert {-0.1, 0.99} == {q[0], q[-1]} and b == pytest.approx(q**2, abs=1e-11)


def zero_hopf(x, p):
    """w' = a + w^2 + |z|^2, z' = (b - w + w^2 + i) z: cycles whose pair has modulus one at b = 0, a < 0."""
    w = x[0]
    return [p.a + w * w + x[1] ** 2 + x[2] ** 2, *spiral(x[1:], p.b - w + w * w, 1.0, 0.0)]


def double_hopf(x, p):
    """r1' = r1 (a - r1^2 - r2^2 / 2), r2' = r2 (b - 3/2 r1^2 - r2^2): the first cycle, r1^2 = a, loses its stability at b = 3/2 a."""
    one, two = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
    return [*spiral(x[:2], p.a - 0.5 * two, 1.0), *spiral(x[2:], p.b - 1.5 * one, 0.6)]


def test_neimark_sacker_points_of_cycles_begin_at_a_zero_hopf_point():
    """Beside the cycle w'' = 2 a w: resonances where sqrt(-2 a) is 1/3, 1/4."""
    flow = cv.FlowProblem(zero_hopf, [-0.3, 0.0, 0.0], {"b": 0.05, "a": -0.09}, scale=1.0)
    start = cycle(flow, lambda t: [0.0, 0.3 * np.cos(t), 0.3 * np.sin(t)])
    graph = cv.diagram(start, over="b", within=(-0.1, 0.3), depth=0)
    assert graph["NS1"].value == pytest.approx(0.0, abs=1e-10)
    locus = cv.locus(graph["NS1"], over="a", within=(-0.1, 0.2))
    assert np.abs(locus.values[:, 0]).max() < 1e-9
    places = {"zero-hopf": 0.0, "resonance-1-3": -0.5 / 9, "resonance-1-4": -0.5 / 16}
    found = {point.kind: point.value for point in locus.points.values()}
    assert found == {kind: pytest.approx((0.0, a), abs=1e-8) for kind, a in places.items()}


@pytest.mark.slow
def test_four_loci_meet_at_a_double_hopf_point():
    """Hopf points at a = 0 and b = 0, Neimark-Sacker points at b = 3/2 a > 0 and a = b / 2 > 0."""
    flow = cv.FlowProblem(double_hopf, [0.0] * 4, {"b": -0.1, "a": 0.09}, scale=1.0)
    graph = cv.diagram(flow, over="b", within=(-0.2, 0.2), depth=0)
    chart = cv.chart(graph, over="a", within=(-0.1, 0.2), regions=False)
    lines = {label: np.abs(locus.values).max(axis=0) for label, locus in chart.loci.items()}
    assert sorted((label[:2], *place) for label, place in lines.items()) == [
        ("HB", pytest.approx(0.0, abs=1e-9), pytest.approx(0.2)), ("HB", pytest.approx(0.2), pytest.approx(0.0, abs=1e-9)),
        ("NS", pytest.approx(0.2), pytest.approx(0.1)), ("NS", pytest.approx(0.2), pytest.approx(0.2 / 1.5)),
    ]  # fmt: skip
    assert chart["HH1"].value == pytest.approx((0.0, 0.0), abs=1e-8)
