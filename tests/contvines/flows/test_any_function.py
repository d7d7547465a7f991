"""A user's right-hand side may do anything: what comes of it is a number or a sentence."""

import math

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import born, van_der_pol


@pytest.mark.parametrize("size", [abs, math.fabs, float, lambda b: np.sqrt(np.abs(b) ** 2)])
def test_a_second_parameter_of_which_the_magnitude_counts(size):
    """x^2 = a |b|: the complex step works for a alone."""
    flow = cv.FlowProblem(lambda x, p: [p.a * size(p.b) - x[0] ** 2], [1.0], {"a": 1.0, "b": 1.0})
    branch = cv.diagram(flow, over="b", within=(0.25, 4.0)).branches["B1"]
    assert branch.points[:, 0] == pytest.approx(np.sqrt(branch.values), rel=1e-10)


def circles(x, p):
    """Of radius sqrt(|b| - 1/2), passed in 2 pi."""
    grows = abs(p.b) - 0.5 - x[0] ** 2 - x[1] ** 2
    return [p.a * (grows * x[0] - x[1]), p.a * (x[0] + grows * x[1])]


def follower(x, p, t):
    return [-x[0] + np.cos(p.b * t)]


@pytest.mark.parametrize(
    ("flow", "low", "amplitude"),
    [
        (cv.FlowProblem(circles, [0.5, 0.0], {"a": 1.0, "b": 1.0}), 0.6, lambda b: np.sqrt(b - 0.5)),
        (
            cv.FlowProblem(follower, [0.0], {"b": 1.0}, period=lambda p: 2 * np.pi / abs(p.b)),
            0.5,
            lambda b: 1.0 / np.sqrt(1.0 + b**2),
        ),
    ],
)
def test_cycles_along_a_parameter_of_which_the_magnitude_counts(flow, low, amplitude):
    branch = cv.diagram(flow.attractor(), over="b", within=(low, 2.0)).branches["B1"]
    assert sorted(branch.range) == [low, 2.0]
    assert branch.measure("max x0") == pytest.approx(amplitude(branch.values), rel=1e-5)


@pytest.mark.parametrize("error", [RuntimeError, KeyError, ZeroDivisionError])
@pytest.mark.parametrize("limited", [lambda x, p: p.a > 0.7, lambda x, p: np.any(np.abs(x[0]) > 1.5)])
def test_a_table_that_ends_ends_cycles_with_its_own_words(error, limited):
    def rates(x, p):
        if limited(x, p):
            raise error("outside of the table")
        return born(x, p)

    flow = cv.FlowProblem(rates, [0.0, 0.0], {"a": -0.2})
    graph = cv.diagram(flow, over="a", within=(-0.5, 2.0))
    assert graph["HB1"].value == pytest.approx(0.0, abs=1e-9)
    assert any(
        error.__name__ in text and "outside of the table" in text for text in graph.branches["B2"].ended
    )
    found, _, _ = flow.population("a").settle(np.array([[1.0, 0.2], [0.1, 0.1]]), 0.5)
    assert {one.kind for one in found} <= {"periodic", "escaped"}


def test_a_motion_that_blows_up_or_slides_ends():
    """x'' = x^3, from 2 at rest, is infinite at t = Gamma(1/4)^2 / (8 sqrt(pi)) = 0.927."""
    with pytest.raises(ValueError, match="the motion escapes.* t = 0.927"):
        cv.FlowProblem(lambda x, p: [x[1], x[0] ** 3], [2.0, 0.0]).attractor()
    with pytest.raises(ValueError, match=r"beyond t = 0\.3.*f jumps"):
        cv.FlowProblem(lambda x, p: -np.sign(x), 0.3).attractor()


def test_a_motion_may_be_large_in_its_own_units():
    """Van der Pol's cycle at mu = 1 in units in which its amplitude is 2e20; period 6.6632868593."""
    unit = 1e20
    flow = cv.FlowProblem(
        lambda x, p: [unit * rate for rate in van_der_pol(x / unit, p)], [unit, 0.0], {"mu": 1.0}
    )
    assert flow.attractor().period == pytest.approx(6.6632868593231, rel=1e-8)


@pytest.mark.parametrize("name", ["x0", "longest", "transient", "doublings", "box", "around", "over"])
def test_parameters_may_have_names_of_arguments(name):
    flow = cv.FlowProblem(
        lambda x, p: [x[1], -x[0] + (p[name] - x[0] ** 2) * x[1]], [1.0, 0.0], {"b": 1.0, name: 0.1}
    )
    population = flow.population_at({name: 0.2}, "b")
    assert [one.word for one in population.settle(np.array([[1.0, 0.0]]), 1.0)[0]] == ["cycle"]
    problem = flow.equilibria("b", {name: 0.2})
    assert [one["word"] for one in problem.simulated_attractors(1.0, 2)] == ["cycle"]
    assert flow.attractor_at({name: 0.2}).parameters[name] == 0.2


@pytest.mark.parametrize(
    ("change", "branch", "words"),
    [
        (lambda x, a: [0.0, ((0.7 - a) ** 0.5).imag * 1e-3j], "B2", "complex numbers"),
        (lambda x, a: [0.0, 0.0] + [0.0] * (a > 0.7), "B1", "3 numbers"),
    ],
)
def test_what_becomes_wrong_somewhere_ends_a_branch(change, branch, words):
    def rates(x, p):
        found = [*born(x, p), 0.0]
        return [rate + more for rate, more in zip(found, change(x, p.a))]

    flow = cv.FlowProblem(rates, [0.0, 0.0], {"a": -0.2})
    ended = cv.diagram(flow, over="a", within=(-0.5, 2.0)).branches[branch]
    assert any(words in text for text in ended.ended)
    assert ended.values.max() <= 0.7 + 1e-6


@pytest.mark.parametrize("mu", [1e2, 1e4, 1e6])
def test_a_hopf_point_of_a_stiff_flow(mu):
    """Trace mu (1 - a^2), determinant 1: eigenvalues are complex within 1 / mu of a = 1."""
    flow = cv.FlowProblem(
        lambda x, p: [x[1], mu * (1.0 - x[0] ** 2) * x[1] - x[0] + p.a], [1.2, 0.0], {"a": 1.2}
    )
    graph = cv.diagram(flow, over="a", within=(0.5, 1.3), depth=0)
    assert [
        (point.kind, round(point.value, 9)) for point in graph.special.values() if point.kind != "end"
    ] == [("hopf", 1.0)]
    assert graph["HB1"].frequency == pytest.approx(1.0)


def test_starts_where_there_is_no_period():
    flow = cv.FlowProblem(follower, [0.0], {"b": 0.5}, period=lambda p: 2.0 * np.pi / p.b)
    motions, index, _ = flow.population("b").settle(np.zeros((3, 1)), -0.5)
    assert [one.kind for one in motions] == ["escaped"]
    assert index.tolist() == [0, 0, 0]
