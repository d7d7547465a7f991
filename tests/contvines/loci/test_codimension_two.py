"""Loci of the Henon map and of its generalization, and the points that a locus and its chart hold, against closed forms; points that come in pairs."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import generalized_henon, generalized_henon_at, henon


def test_henon_loci_are_parabolas():
    problem = cv.MapProblem(henon, [0.6, 0.2], {"a": 0.2, "b": 0.3})
    graph = cv.diagram(problem, over="a", within=(-0.5, 1.0), depth=1)
    # fold 4 a = -(1 - b)^2, doubling 4 a = 3 (1 - b)^2, second doubling 4 a = 4 (1 - b)^2 + (1 + b)^2
    closed = {"LP1": lambda b: -((1 - b) ** 2) / 4, "PD1": lambda b: 3 * (1 - b) ** 2 / 4}
    closed["PD2"] = lambda b: (1 - b) ** 2 + (1 + b) ** 2 / 4
    for label, form in closed.items():
        a, b = cv.locus(graph[label], over="b", within=(0.1, 0.6)).values.T
        assert a == pytest.approx(form(b), abs=1e-12)


def test_a_doubling_that_was_met_from_the_doubled_side():
    """The 2-cycle was born at 4 a = 3 (1 - b)^2; the diagram begins on it and does not go beyond."""
    problem = cv.MapProblem(henon, [[1.39, -0.07], [-0.22, 0.42]], {"a": 0.6, "b": 0.3}, cycle=2)
    graph = cv.diagram(problem, within=(0.3, 0.7), depth=0)
    assert graph["PD1"].multipliers.real.max() == pytest.approx(1.0, abs=1e-6)  # of both iterations
    a, b = cv.locus(graph["PD1"], over="b", within=(0.0, 0.6)).values.T
    assert a == pytest.approx(0.75 * (1.0 - b) ** 2, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("r", [0.0, -0.1])
def test_strong_resonances_on_a_locus_and_its_chart(tmp_path, r):
    graph = cv.diagram(generalized_henon((0.6, 0.6), 1.0, r=r), over="be", within=(0.5, 1.5), depth=0)
    chart = cv.chart(graph, over="al", within=(-2.0, 4.0), depth=0, regions=False)
    chart.save(tmp_path / "chart.vines")
    for one in (chart, cv.load(tmp_path / "chart.vines")):
        assert one.points == {
            label: point for locus in one.loci.values() for label, point in locus.points.items()
        }
    (locus,) = (locus for locus in chart.loci.values() if locus.kind == "neimark-sacker")
    assert locus.values[:, 0] - r * locus.branch.points[:, 0] == pytest.approx(1.0, abs=1e-10)
    traces = {"R11": 2.0, "R21": -2.0, "R31": -1.0, "R41": 0.0}
    assert set(locus.points) == set(
        traces
    )  # at r = 0 the map preserves areas all along: it has no Chenciner point
    for label, trace in traces.items():
        x, be, al = generalized_henon_at(trace, r)
        point = locus.points[label]
        assert point.value == pytest.approx((be, al), abs=1e-9) and point.u == pytest.approx([x, x], abs=1e-8)
        assert locus.label in point.on


def unit(s):
    return 1.0 / (1.0 + np.exp(-s))


def rates(x, p):
    return [-x[0] + unit(p.rx + 10 * x[0] - 10 * x[1]), -x[1] + unit(p.ry + 10 * x[0] + 2 * x[1])]


def test_points_on_folds_come_in_pairs_however_the_unknowns_are_scaled():
    """Wilson and Cowan's two populations (Hoppensteadt and Izhikevich, Weakly Connected Neural Networks, 1997, section 2.3.3) have the symmetry
    (x, y, rx, ry) -> (1 - x, 1 - y, -rx, -12 - ry) for a = b = c = 10, d = -2: points of codimension two come in pairs.
    """
    flow = cv.FlowProblem(rates, [0.1, 0.1], {"rx": -4.0, "ry": -6.0})  # y is 0.003 there, and goes to 1
    graph = cv.diagram(flow.equilibria("rx"), over="rx", within=(-8.0, 8.0), depth=0)
    one, other = (cv.locus(graph[label], over="ry", within=(-12.0, 6.0)) for label in ("LP1", "LP4"))
    first = sorted((point.kind, *point.value) for point in one.points.values())
    second = sorted((point.kind, -point.value[0], -12.0 - point.value[1]) for point in other.points.values())
    assert [kind for kind, *_ in first] == ["bogdanov-takens", "bogdanov-takens", "cusp"]
    assert [kind for kind, *_ in second] == [kind for kind, *_ in first]
    assert np.allclose([row[1:] for row in first], [row[1:] for row in second], rtol=0.0, atol=1e-8)
