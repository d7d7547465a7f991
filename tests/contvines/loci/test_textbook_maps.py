"""Maps and flows of the literature in two parameters, against closed forms and solves of their own in many digits."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def places_are(chart, places, close):
    found = {point.kind: point.value for point in chart.points.values()}
    assert found == {kind: pytest.approx(place, abs=close) for kind, place in places.items()}


def test_burgers_map_where_a_pitchfork_meets_a_flip():
    # x' = (1 - nu) x - y^2, y' = (1 + mu + x) y, mirror y -> -y. (0, 0) has multipliers 1 - nu, 1 + mu; beside it x = -mu, y^2 = nu mu with
    # trace 2 - nu and determinant 1 - nu + 2 nu mu: symmetry breaking mu = 0, flip nu = 2, Neimark-Sacker mu = 1/2 with 1:4, 1:3 at nu = 2, 3
    def burgers(x, p):
        return [(1 - p.nu) * x[0] - x[1] ** 2, (1 + p.mu + x[0]) * x[1]]

    problem = cv.MapProblem(burgers, [0.0, 0.0], {"mu": -0.3, "nu": 0.9}, mirror=[[1, 0], [0, -1]])
    graph = cv.diagram(problem, within=(-0.5, 0.9), depth=2)
    chart = cv.chart(graph, over="nu", within=(0.1, 3.9), regions=False)
    lines = {"symmetry-breaking": (0, 0.0), "neimark-sacker": (0, 0.5), "period-doubling": (1, 2.0)}
    # where branches cross none folds
    assert sorted(locus.kind for locus in chart.loci.values()) == sorted(lines)
    for locus in chart.loci.values():
        axis, place = lines[locus.kind]
        assert np.abs(locus.values[:, axis] - place).max() < 1e-11
        assert np.ptp(locus.values[:, 1 - axis]) > 1.39  # from one end to the other
    expected = {"fold-flip": (0.0, 2.0), "resonance-1-4": (0.5, 2.0), "resonance-1-3": (0.5, 3.0)}
    places_are(chart, expected, 1e-9)


def test_kopels_duopoly_where_branches_cross_and_do_not_fold():
    # x = y = 1 - 1/mu, multipliers 1 - rho +- rho (mu - 2): the pitchfork mu = 3 meets the doubling at rho = 1
    def kopel(u, p):
        return u * (1 - p.rho) + p.rho * p.mu * u[::-1] * (1 - u[::-1])

    problem = cv.MapProblem(kopel, [0.5, 0.5], {"mu": 2.0, "rho": 0.9})
    graph = cv.diagram(problem, over="mu", within=(2.0, 3.4), depth=0)
    chart = cv.chart(graph, over="rho", within=(0.8, 1.2), depth=1, regions=False)
    assert all(locus.kind != "fold" for locus in chart.loci.values())
    (meeting,) = chart.of_kind("fold-flip")
    assert meeting.value == pytest.approx((3.0, 1.0), abs=1e-8)


def test_truncated_normal_form_of_the_resonance_1_2():
    """The map of MatContM's tutorial (Govaerts, Khoshsiar Ghaziani, Kuznetsov, Meijer), with C = D = 1, by closed forms and a chart of default depth.

    At rest trace b2 - 2 and determinant 1 - b1 - b2. The null vectors of a branch point are (1, 2) and (b1 / 2, 1): the left one turns.
    """

    def normal_form(u, p):
        x, y = u
        return [y - x, p.beta1 * x + (p.beta2 - 1) * y + x**3 + x**2 * y]

    problem = cv.MapProblem(normal_form, [0.0, 0.0], {"beta1": -2.0, "beta2": 0.0})
    graph = cv.diagram(problem, over="beta2", within=(-1.0, 6.0))
    chart = cv.chart(graph, over="beta1", within=(-5.0, 2.0), regions=False)
    assert chart.message == "finished"
    for label, condition in (("NS1", lambda b2, b1: b1 + b2), ("BP1", lambda b2, b1: b1 + 2 * b2 - 4)):
        assert np.abs([condition(*value) for value in chart.loci[label].values]).max() < 1e-11
    places = {"resonance-1-1": (4, -4), "resonance-1-2": (0, 0), "resonance-1-3": (1, -1), "resonance-1-4": (2, -2), "fold-flip": (2, 0)}  # fmt: skip
    places_are(chart, places, 1e-10)
