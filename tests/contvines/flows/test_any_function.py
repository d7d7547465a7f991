"""A user's right-hand side may do anything: what comes of it is a number or a sentence."""

import math

import numpy as np
import pytest

import contvines
from contvines.flows.simulation import Escaped


@pytest.mark.parametrize("size", [abs, math.fabs, lambda b: float(b), lambda b: np.sqrt(np.abs(b) ** 2)])
def test_a_second_parameter_of_which_the_magnitude_counts(size):
    """x^2 = a |b|: the complex step works for a alone."""
    flow = contvines.FlowProblem(lambda x, p: [p.a * size(p.b) - x[0] ** 2], [1.0], {"a": 1.0, "b": 1.0})
    branch = contvines.diagram(flow, over="b", within=(0.25, 4.0)).branches["B1"]
    assert branch.points[:, 0] == pytest.approx(np.sqrt(branch.values), rel=1e-10)
    slope = flow.field.against(flow.values.against("b")).slope(np.ones((3, 1)), 2.0)
    assert slope == pytest.approx(np.ones((3, 1)))


def test_cycles_along_a_parameter_of_which_the_magnitude_counts():
    """The circle of radius sqrt(|b| - 1/2), passed in 2 pi."""

    def rates(x, p):
        grows = abs(p.b) - 0.5 - x[0] ** 2 - x[1] ** 2
        return [p.a * (grows * x[0] - x[1]), p.a * (x[0] + grows * x[1])]

    flow = contvines.FlowProblem(rates, [0.1, 0.0], {"a": 1.0, "b": 1.0})
    branch = contvines.diagram(flow.attractor([0.5, 0.0]), over="b", within=(0.6, 2.0)).branches["B1"]
    assert sorted(branch.range) == [0.6, 2.0]
    assert branch.measure("max x0") == pytest.approx(np.sqrt(branch.values - 0.5), rel=1e-5)


def test_a_period_that_takes_the_magnitude_of_the_frequency():
    """x' = -x + cos(w t): amplitude 1 / sqrt(1 + w^2)."""
    flow = contvines.FlowProblem(
        lambda x, p, t: [-x[0] + np.cos(p.w * t)], [0.0], {"w": 1.0}, period=lambda p: 2 * np.pi / abs(p.w)
    )
    branch = contvines.diagram(flow, over="w", within=(0.5, 2.0)).branches["B1"]
    assert branch.values.min() == 0.5 and branch.values.max() == 2.0
    assert branch.measure("max x0") == pytest.approx(1.0 / np.sqrt(1.0 + branch.values**2), rel=1e-8)


@pytest.mark.parametrize("error", [RuntimeError, KeyError, ZeroDivisionError])
@pytest.mark.parametrize("limited", [lambda x, p: p.a > 0.7, lambda x, p: np.any(np.abs(x[0]) > 1.5)])
def test_a_table_that_ends_ends_cycles_with_its_own_words(error, limited):
    def rates(x, p):
        if limited(x, p):
            raise error("outside of the table")
        return [x[1], -x[0] + (p.a - x[0] ** 2) * x[1]]

    flow = contvines.FlowProblem(rates, [0.0, 0.0], {"a": -0.2})
    graph = contvines.diagram(flow, over="a", within=(-0.5, 2.0))
    assert graph["HB1"].value == pytest.approx(0.0, abs=1e-9)
    assert any(
        error.__name__ in text and "outside of the table" in text for text in graph.branches["B2"].ended
    )
    found, _, _ = flow.population("a").settle(np.array([[1.0, 0.2], [0.1, 0.1]]), 0.5)
    assert {one.kind for one in found} <= {"periodic", "escaped"}


def test_a_motion_that_blows_up_ends():
    """x'' = x^3 from x = 2 at rest: x'^2 = (x^4 - 16) / 2, so that infinity is reached at t = Gamma(1/4)^2 / (8 sqrt(pi))."""
    flow = contvines.FlowProblem(lambda x, p: [x[1], x[0] ** 3 + p.a], [1.0, 0.0], {"a": 0.0})
    when = math.gamma(0.25) ** 2 / (8.0 * math.sqrt(math.pi))
    with pytest.raises(Escaped, match="the motion escapes") as ended:
        flow.attractor([2.0, 0.0])
    assert float(str(ended.value).rpartition("=")[2]) == pytest.approx(when, rel=1e-3)


def test_a_motion_may_be_large_in_its_own_units():
    """Van der Pol's cycle at mu = 1 in units in which its amplitude is 2e20; period 6.6632868593."""
    unit = 1e20
    flow = contvines.FlowProblem(
        lambda x, p: [x[1], p.mu * (1.0 - (x[0] / unit) ** 2) * x[1] - x[0]], [unit, 0.0], {"mu": 1.0}
    )
    assert flow.attractor().period == pytest.approx(6.6632868593231, rel=1e-8)


@pytest.mark.parametrize("name", ["x0", "longest", "transient", "doublings", "box", "around", "over"])
def test_parameters_may_have_names_of_arguments(name):
    flow = contvines.FlowProblem(
        lambda x, p: [x[1], -x[0] + (getattr(p, name) - x[0] ** 2) * x[1]], [1.0, 0.0], {"b": 1.0, name: 0.1}
    )
    population = flow.population_at({name: 0.2}, "b")
    assert [one.word for one in population.settle(np.array([[1.0, 0.0]]), 1.0)[0]] == ["cycle"]
    problem = flow.equilibria("b", {name: 0.2})
    assert [one["word"] for one in problem.simulated_attractors(1.0, 2)] == ["cycle"]
    assert flow.attractor_at({name: 0.2}).parameters[name] == 0.2


def test_complex_numbers_end_a_branch():
    def rates(x, p):
        return [x[1], -x[0] + (p.a - x[0] ** 2) * x[1] + 1e-3 * ((0.7 - p.a) ** 0.5).imag * 1j]

    flow = contvines.FlowProblem(rates, [0.0, 0.0], {"a": -0.2})
    graph = contvines.diagram(flow, over="a", within=(-0.5, 2.0))
    assert any("complex numbers" in text for text in graph.branches["B2"].ended)
    assert graph.branches["B2"].values.max() <= 0.7


def test_a_number_too_many_somewhere_is_told():
    flow = contvines.FlowProblem(
        lambda x, p: [x[1], -x[0] - x[1]] + [0.0] * (p.a > 0.7), [0.0, 0.0], {"a": -0.2}
    )
    graph = contvines.diagram(flow, over="a", within=(-0.5, 2.0))
    assert graph.branches["B1"].values.max() == pytest.approx(0.7, abs=1e-6)
    assert any("3 numbers" in text for text in graph.branches["B1"].ended)


@pytest.mark.parametrize("mu", [1e2, 1e4, 1e6])
def test_a_hopf_point_of_a_stiff_flow(mu):
    """Trace mu (1 - a^2), determinant 1: eigenvalues are complex within 1 / mu of a = 1."""
    flow = contvines.FlowProblem(
        lambda x, p: [x[1], mu * (1.0 - x[0] ** 2) * x[1] - x[0] + p.a], [1.2, 0.0], {"a": 1.2}
    )
    graph = contvines.diagram(flow, over="a", within=(0.5, 1.3), depth=0)
    assert [
        (point.kind, round(point.value, 9)) for point in graph.special.values() if point.kind != "end"
    ] == [("hopf", 1.0)]
    assert graph["HB1"].frequency == pytest.approx(1.0)


def forced(period):
    return contvines.FlowProblem(lambda x, p, t: [-x[0] + np.cos(p.w * t)], [0.0], {"w": 0.5}, period=period)


def test_what_is_no_period_of_the_forcing_is_refused():
    with pytest.raises(ValueError, match=r"period = 6 at the start is no period of f\(x, p, t\) in t"):
        forced(lambda p: 3.0 / p.w)
    for rounds in (1, 2):
        assert forced(lambda p, rounds=rounds: rounds * 2.0 * np.pi / p.w).field.forced


def test_starts_where_there_is_no_period():
    population = forced(lambda p: 2.0 * np.pi / p.w).population("w")
    motions, index, _ = population.settle(np.zeros((3, 1)), -0.5)
    assert [one.kind for one in motions] == ["escaped"]
    assert index.tolist() == [0, 0, 0]
