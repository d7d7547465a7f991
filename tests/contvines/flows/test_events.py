"""Events that stop motions, and names of states.

Stuart-Landau's oscillator has the cycle x^2 + y^2 = mu, which touches x = 3/2 at mu = 9/4.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.flows.simulation import Stopped


def stuart_landau(x, p):
    square = x[0] ** 2 + x[1] ** 2
    return [p.mu * x[0] - x[1] - x[0] * square, x[0] + p.mu * x[1] - x[1] * square]


def walled(**options):
    events = {"wall": lambda x, p: 1.5 - x[0]}
    return cv.FlowProblem(
        stuart_landau, [0.1, 0.0], {"mu": -0.5}, states=("x", "y"), events=events, **options
    )


def test_a_branch_of_cycles_ends_where_it_touches_an_event():
    graph = cv.diagram(walled(), over="mu", within=(-1.0, 4.0))
    (point,) = graph.of_kind("event")
    assert point.label == "EV1"
    assert abs(point.value - 2.25) < max(point.location_error, 1e-12) < 1e-5
    assert "wall" in " ".join(point.remarks)
    assert graph.branches[point.branch].measure("max x")[-1] == pytest.approx(1.5, abs=1e-7)


def test_a_branch_of_equilibria_ends_where_it_meets_an_event():
    flow = cv.FlowProblem(lambda x, p: [p.a - x[0]], [0.0], {"a": 0.0}, events={"lid": lambda x, p: 1 - x[0]})
    (point,) = cv.diagram(flow, over="a", within=(-1.0, 4.0)).of_kind("event")
    assert point.value == pytest.approx(1.0, abs=1e-12)


def test_motions_stop_at_an_event():
    flow = walled()
    with pytest.raises(Stopped, match="the event wall stops the motion"):
        flow.attractor([0.5, 0.0], mu=3.0)
    with pytest.raises(Stopped, match="beyond the event wall"):
        flow.attractor([2.5, 0.0], mu=3.0)
    population = flow.population("mu", box=[(-1.0, 3.0), (-1.0, 1.0)])
    motions, index, _ = population.settle(np.array([[0.2, 0.1], [2.5, 0.0]]), 1.0)
    assert [motions[k].kind for k in index] == ["periodic", "stopped"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"events": [1]}, "must be functions by name"),
        ({"events": {"wall": 1}}, "must be a name with a function"),
        ({"events": {"wall": lambda x, p: x[0]}}, "wall is 0 at x0"),
        ({"events": {"wall": lambda x, p: x[5]}}, "the event wall fails"),
        ({"states": ("x",)}, "has 1 names; the flow has 2 states"),
        ({"states": ("x", "x")}, "'x' is there twice"),
        ({"states": ("x", "period")}, "that of a measure"),
        ({"states": "xy"}, "must be names"),
        ({"period": np.inf}, "period is inf at the start"),
        ({"period": "2"}, "period = '2' must be a positive number"),
        ({"period": lambda p: p.omega}, "period raises AttributeError: there is no parameter 'omega'"),
        ({"period": 2.0}, "called with .x, p, t., as there is period="),
        ({"settings": "loose"}, "settings = 'loose' must be values by name"),
        ({"mirror": lambda x: x[5]}, "mirror raises IndexError"),
        ({"mirror": lambda x: np.nan * x}, "mirror returns .nan, nan."),
    ],
)
def test_bad_events_and_names_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        cv.FlowProblem(stuart_landau, [0.0, 0.0], {"mu": 1.0}, **options)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda flow: flow.attractor([np.nan, 0.0]), "x0 = .nan, 0.0. must be finite"),
        (lambda flow: flow.attractor(transient=np.nan), "transient = nan must be a positive time"),
        (lambda flow: flow.attractor(transient=-1.0), "transient = -1.0 must be a positive time"),
        (lambda flow: flow.attractor(longest=0), "longest = 0 must be a whole number, 1 or more"),
        (lambda flow: flow.attractor(doublings=1.5), "doublings = 1.5 must be a whole number"),
        (lambda flow: flow.cycle(range(6), np.full((6, 2), np.nan)), "states must be finite"),
        (lambda flow: flow.cycle("abc", np.ones((6, 2))), "times must be numbers"),
        (lambda flow: flow.cycle(range(6), np.ones((6, 2)), rounds=0), "rounds = 0 must be a whole number"),
        (lambda flow: flow.population(box=[(0.0, 1.0), (1.0,)]), "give 2 pairs"),
        (lambda flow: flow.population(box=[(0.0, 1.0), (1.0, np.inf)]), "give 2 pairs"),
        (lambda flow: flow.population(around=np.ones((4, 3))), "around has shape .4, 3."),
    ],
)
def test_bad_arguments_of_methods_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(cv.FlowProblem(stuart_landau, [0.5, 0.0], {"mu": 1.0}))


def test_a_start_that_is_no_solution_is_told_by_the_name_of_the_state():
    flow = cv.FlowProblem(lambda x, p: [p.a - x[0], -x[1]], [0.2, 0.0], {"a": 0.5}, states=("x", "y"))
    assert "begins at x = 0.5 instead of 0.2" in str(cv.diagram(flow, over="a", within=(-1.0, 1.0)))
