"""The points of codimension two that a locus itself holds, against the closed forms of the Henon map."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def henon(x, p):
    return np.array([x[1], p.a - p.b * x[0] - x[1] ** 2])


@pytest.fixture(scope="module")
def neimark_sacker():
    problem = cv.MapProblem(henon, [0.6, 0.6], {"a": 1.0, "b": 0.5}, parameter="b")
    graph = cv.diagram(problem, over="b", within=(0.5, 1.5), depth=0)
    return cv.locus(graph.special["NS1"], over="a", within=(-2.0, 4.0), bounds=(0.5, 1.5))


def test_strong_resonances_of_the_henon_map(neimark_sacker):
    # at b = 1 the fixed point y has multipliers exp(+-i theta) with cos theta = -y, and a = y^2 + 2 y
    cosines = {"R11": 1.0, "R21": -1.0, "R31": -0.5, "R41": 0.0}
    points = neimark_sacker.points
    assert set(points) == set(cosines)  # the map preserves areas all along: it has no Chenciner point
    for label, cosine in cosines.items():
        assert points[label].value == pytest.approx((1.0, cosine**2 - 2.0 * cosine), abs=1e-8)
        assert points[label].u == pytest.approx([-cosine, -cosine], abs=1e-8)
        assert points[label].on == [neimark_sacker.label]


def test_a_chart_and_its_loci_hold_the_same_points(tmp_path):
    problem = cv.MapProblem(henon, [0.6, 0.6], {"a": 1.0, "b": 0.5}, parameter="b")
    graph = cv.diagram(problem, over="b", within=(0.5, 1.5), depth=0)
    chart = cv.chart(graph, over="a", within=(-2.0, 4.0), depth=0, regions=False)
    chart.save(tmp_path / "chart.vines")
    again = cv.load(tmp_path / "chart.vines")
    assert isinstance(again, cv.Chart)
    for one in (chart, again):
        held = {label: point for locus in one.loci.values() for label, point in locus.points.items()}
        assert held and held == one.points
        assert one.points["R31"].value == pytest.approx((1.0, 1.25), abs=1e-8)


def test_branches_that_cross_do_not_fold_there():
    # Kopel's duopoly: x = y = 1 - 1/mu, multipliers 1 - rho +- rho (mu - 2): the pitchfork mu = 3 meets the doubling at rho = 1
    def kopel(u, p):
        return u * (1 - p.rho) + p.rho * p.mu * u[::-1] * (1 - u[::-1])

    problem = cv.MapProblem(kopel, [0.5, 0.5], {"mu": 2.0, "rho": 0.9}, parameter="mu")
    graph = cv.diagram(problem, over="mu", within=(2.0, 3.4), depth=0)
    chart = cv.chart(graph, over="rho", within=(0.8, 1.2), depth=1, regions=False)
    assert all(locus.kind != "fold" for locus in chart.loci.values())
    (meeting,) = [point for point in chart.points.values() if point.kind == "fold-flip"]
    assert meeting.value == pytest.approx((3.0, 1.0), abs=1e-8)
