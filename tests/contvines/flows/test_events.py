"""Events that stop motions, and names of states.

Stuart-Landau's oscillator has the cycle x^2 + y^2 = mu, which touches x = 3/2 at mu = 9/4.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.flows.simulation import Stopped
from tests.contvines.flows.shooting import landau


@pytest.fixture
def walled():
    events = {"wall": lambda x, p: 1.5 - x[0]}
    return cv.FlowProblem(landau, [0.1, 0.0], {"mu": -0.5}, states=("x", "y"), events=events)


def test_a_branch_of_cycles_ends_where_it_touches_an_event(walled):
    graph = cv.diagram(walled, over="mu", within=(-1.0, 4.0))
    (point,) = graph.of_kind("event")
    assert point.label == "EV1"
    assert abs(point.value - 2.25) < max(point.location_error, 1e-12) < 1e-5
    assert "wall" in " ".join(point.remarks)
    assert graph.branches[point.branch].measure("max x")[-1] == pytest.approx(1.5, abs=1e-7)


def test_a_branch_of_equilibria_ends_where_it_meets_an_event():
    flow = cv.FlowProblem(lambda x, p: [p.a - x[0]], [0.0], {"a": 0.0}, events={"lid": lambda x, p: 1 - x[0]})
    (point,) = cv.diagram(flow, over="a", within=(-1.0, 4.0)).of_kind("event")
    assert point.value == pytest.approx(1.0, abs=1e-12)


def test_motions_stop_at_an_event(walled):
    with pytest.raises(Stopped, match="the event wall stops the motion"):
        walled.attractor([0.5, 0.0], mu=3.0)
    with pytest.raises(Stopped, match="beyond the event wall"):
        walled.attractor([2.5, 0.0], mu=3.0)
    population = walled.population("mu", box=[(-1.0, 3.0), (-1.0, 1.0)])
    motions, index, _ = population.settle(np.array([[0.2, 0.1], [2.5, 0.0]]), 1.0)
    assert [motions[k].kind for k in index] == ["periodic", "stopped"]


def test_a_start_that_is_no_solution_is_told_by_the_name_of_the_state():
    flow = cv.FlowProblem(lambda x, p: [p.a - x[0], -x[1]], [0.2, 0.0], {"a": 0.5}, states=("x", "y"))
    assert "begins at x = 0.5 instead of 0.2" in str(cv.diagram(flow, over="a", within=(-1.0, 1.0)))
