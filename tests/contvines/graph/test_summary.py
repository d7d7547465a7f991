"""The summary of a graph's stable motions: against what the equations say."""

import contvines as cv
from contvines.graph.table import summary
from orbits import Machine
from orbits.symbols import cos


def test_a_logistic_map_is_summarised():
    """x' = a x (1 - x): the fixed point 1 - 1/a is stable from a = 1 to 3, the cycle of two from there to 1 + sqrt 6 = 3.449."""
    problem = cv.MapProblem(lambda x, a: a * x * (1.0 - x), [0.5], 2.0)
    graph = cv.diagram(problem, within=(1.5, 3.5), depth=1)
    told = summary(graph, 100)
    assert "1.5..3" in told and "3..3.449" in told
    assert "no stable motion on a branch in 2.53 % of the interval" in told  # (3.5 - 3.449)/2
    assert "3.449 to 3.5" in told


def test_an_atlas_in_brief_has_what_most_starts_reach():
    """Of the cubic map x' = a x - x^3, odd, all starts with |x| < 1 reach one of the two fixed points +-(a - 1)^(1/2), stable from a = 1 to 2."""
    problem = cv.MapProblem(lambda x, a: a * x - x**3, [0.5], 1.5)
    population = problem.population(box=[(-0.9, 0.9)])
    atlas = cv.atlas(population, within=(1.2, 1.8), values=2, starts=10, scan=0, depth=0)
    told = summary(atlas, 100, brief=True).splitlines()
    assert [line.split()[-2] for line in told if line.startswith("1-cycle k=1")] == ["50.00%", "50.00%"]
    assert "starts simulated at 2 values" in told[-1]
    assert "share of starts" not in summary(atlas, 100)  # the tables that follow have it


def test_motions_of_a_machine_without_walls_are_not_said_to_have_no_impacts():
    """x'' + x'/5 + x = cos(Omega t) is smooth, its only motion never hits anything: nothing is said of impacts."""
    machine = Machine(
        name="plain", states=("x", "v"), parameters={"frequency": 0.5}, phase_rate="frequency",
        motion=lambda state, phase, p, contact: (state.v, cos(phase) - 0.2 * state.v - state.x), contacts=[],
    )  # fmt: skip
    graph = cv.diagram(machine.orbit(""), over="frequency", within=(0.4, 1.5), depth=0)
    told = summary(graph, 100)
    assert (
        "no impacts" not in told and "5.025 at 0.99" in told
    )  # 1/(0.2 sqrt(0.99)), at sqrt(0.98), or the point next to it
