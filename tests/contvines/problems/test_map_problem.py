"""MapProblem: logistic and Henon maps against the literature."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import henon_of


def logistic(x, r):
    return r * x * (1 - x)


def values(graph, kind):
    return [point.value for point in graph.special.values() if point.kind == kind]


@pytest.fixture(scope="module")
def cascade():
    return cv.diagram(cv.MapProblem(logistic, [0.5], 2.5, parameter="r"), within=(2.0, 3.6), depth=4)


def test_logistic_cascade(cascade):
    """3, 1 + sqrt 6 exactly (Strogatz, section 10.3); the others OEIS A086180 and A091517, 3.56875941954382..."""
    literature = [3.0, 1.0 + np.sqrt(6.0), 3.5440903595519228, 3.5644072660954325, 3.5687594195438250]
    assert values(cascade, "period-doubling") == pytest.approx(literature, abs=1e-12)
    assert [branch.description["cycle"] for branch in cascade] == [1, 2, 4, 8, 16]
    assert all(point.criticality == "supercritical" for point in cascade.of_kind("period-doubling"))
    # Kuznetsov, (4.10): f_xx^2 / 4 + f_xxx / 6 = r^2
    assert cascade["PD1"].coefficient == pytest.approx(9.0, rel=1e-5)
    for branch, (low, high) in zip(cascade, zip([2.0, *literature], literature)):
        np.testing.assert_allclose(branch.stable_intervals(), [(low, high)], atol=1e-12)


def test_logistic_two_cycle_is_the_closed_form(cascade):
    """x = (r + 1 +- sqrt((r - 3)(r + 1)))/(2 r)."""
    branch = cascade["B2"]
    r = branch.values
    root = np.sqrt(np.maximum((r - 3.0) * (r + 1.0), 0.0))
    exact = np.stack([(r + 1.0 - root) / (2.0 * r), (r + 1.0 + root) / (2.0 * r)], axis=1)
    np.testing.assert_allclose(np.sort(branch.points, axis=1), exact, atol=1e-7)  # a square root at r = 3
    np.testing.assert_allclose(np.sort(branch.points, axis=1)[2:], exact[2:], atol=1e-12)


def test_henon_cascade():
    """b = 0.3: fold -(1-b)^2/4, doublings 3(1-b)^2/4 and (1-b)^2 + (1+b)^2/4 exactly; then 1.02585541, 1.05112566
    (Derrida, Gervois, Pomeau, J. Phys. A 12 (1979) 269)."""
    graph = cv.diagram(cv.MapProblem(henon_of, [0.7, 0.2], 0.2, parameter="a"), within=(-0.2, 1.1), depth=3)
    assert values(graph, "fold") == pytest.approx([-0.1225], abs=1e-13)
    found = values(graph, "period-doubling")
    assert found[:2] == pytest.approx([0.3675, 0.9125], abs=1e-12)
    assert found[2:] == pytest.approx([1.02585541, 1.05112566], abs=6e-9)
    for branch in graph:  # the map contracts areas by b per iteration
        n = branch.description["cycle"]
        np.testing.assert_allclose(np.prod(branch.multipliers, axis=1).real, (-0.3) ** n, rtol=1e-8)


def test_period_three_window():
    """Born at 1 + sqrt 8 (Strogatz, section 10.2), doubling at 3.8414990075..."""
    start = [0.149888, 0.489172, 0.959299]
    graph = cv.diagram(
        cv.MapProblem(logistic, start, 3.84, cycle=3, parameter="r"), within=(3.7, 3.87), depth=1
    )
    assert values(graph, "fold") == pytest.approx([1.0 + np.sqrt(8.0)], abs=1e-12)
    assert values(graph, "period-doubling")[0] == pytest.approx(3.8414990075, abs=1e-10)
    assert graph["LP1"].multipliers == pytest.approx([1.0], abs=1e-7)


def test_doubled_cycle_that_falls_back_is_recognised():
    """Followed from a 2-cycle the branch ends at its birth, and the fixed points are found there."""
    start = [0.5130445, 0.7994555]
    graph = cv.diagram(
        cv.MapProblem(logistic, start, 3.2, cycle=2, parameter="r"), within=(2.5, 3.4), depth=2
    )
    assert len(graph) == 2 and values(graph, "period-doubling") == pytest.approx([3.0], abs=1e-12)
    assert graph["B2"].description["cycle"] == 1 and "PD1" in graph["B1"].ended[0]
    assert graph["PD1"].branch == "B2" and graph["PD1"].criticality == "supercritical"
    assert len(graph.switches) == 1


@pytest.mark.parametrize("repeat", [2, 3, 8, 32])
def test_a_repeated_start_is_followed_as_its_root(repeat):
    """x* = 1 - 1/r written many times is the fixed point, whose multiplier 2 - r passes -1 at r = 3."""
    problem = cv.MapProblem(logistic, [0.6] * repeat, 2.5, cycle=repeat, parameter="r")
    graph = cv.diagram(problem, within=(2.2, 3.2), depth=0)
    assert graph["B1"].description["cycle"] == 1 and graph["B1"].points.shape[1] == 1
    (doubling,) = graph.of_kind("period-doubling")
    assert doubling.value == pytest.approx(3.0, abs=1e-12) and not graph.of_kind("branch-point")


def test_area_preserving_map_has_no_spurious_events():
    """Henon's map with b = -1 preserves areas: elliptic multipliers stay on the circle until the flip.

    x' = 1 - a x^2 - y, y' = x: fixed point a x^2 + 2 x = 1, trace -2 a x; the trace is -2 where a x = 1, so a = 3.
    """
    problem = cv.MapProblem(
        lambda x, a: np.array([1 - a * x[0] ** 2 - x[1], x[0]]), [0.4, 0.4], 0.5, parameter="a"
    )
    graph = cv.diagram(problem, within=(0.1, 3.5), depth=0)
    assert not graph.of_kind("neimark-sacker") and not graph.of_kind("branch-point")
    assert values(graph, "period-doubling") == pytest.approx([3.0], abs=1e-9)
