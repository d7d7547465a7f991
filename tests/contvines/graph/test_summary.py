"""The summary of a graph's stable motions: against what the equations say."""

import numpy as np

import contvines as cv
from contvines.graph.summary import summary


def test_a_logistic_map_is_summarised():
    """x' = a x (1 - x): the fixed point 1 - 1/a is stable from a = 1 to 3, the cycle of two from there to 1 + sqrt 6 = 3.449."""
    problem = cv.MapProblem(lambda x, a: a * x * (1.0 - x), np.array([0.5]), 2.0)
    graph = cv.diagram(problem, within=(1.5, 3.5), depth=1)
    told = summary(graph, 100)
    assert "1.5..3" in told and "3..3.449" in told
    assert "no stable motion on a branch in 2.53 % of the interval" in told  # (3.5 - 3.449)/2
    assert "3.449 to 3.5" in told
