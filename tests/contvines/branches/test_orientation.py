"""Branches are one line: tangents, those of special points too, point along it, whichever way it was traced."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.continuation.trace import chunks


@pytest.mark.parametrize("start", [-1.2, 0.0, 1.2])
def test_tangents_of_special_points_follow_the_branch(start):
    """p = u^3 - u, begun before, between and behind its folds at u = -1/sqrt(3) and 1/sqrt(3)."""
    problem = cv.AlgebraicProblem(lambda u, p: u**3 - u - p, [start], start**3 - start)
    graph = cv.diagram(problem, within=(-2.0, 2.0))
    branch = graph["B1"]
    folds = graph.of_kind("fold")
    assert sorted(abs(point.u[0]) for point in folds) == pytest.approx([1 / np.sqrt(3)] * 2)
    for index, label in branch.marks:
        point = graph[label]
        assert point.tangent @ branch.tangents[index] > 0.9 * np.linalg.norm(point.tangent) ** 2
        if 0 < index < len(branch) - 1:
            along = branch.points[index + 1] - branch.points[index - 1]
            assert point.tangent[:-1] @ along > 0.0


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("end", [0.7, 1.0 / 3.0, 0.9123456789])
def test_the_end_of_the_interval_is_met_exactly_and_without_a_change_of_sign(direction, end):
    """Of u = sin 3p + p^3/5, a branch without special points, no determinant changes its sign, not even at the ends."""

    def equations(u, p):
        return np.array([u[0] - np.sin(3 * p) - p**3 / 5, u[1] - u[0] * p])

    problem = cv.AlgebraicProblem(equations, [0.0, 0.0], 0.0)
    engine = Engine(problem, (-end, end), Settings())
    start = engine.start(np.zeros(2), 0.0)
    if start.tangent[-1] * direction < 0.0:
        start = start._replace(tangent=-start.tangent, sign=-start.sign)
    signs, last = [], np.nan
    for chunk in chunks(engine, start):
        signs += list(np.sign(chunk.signs))
        last = chunk.values[-1]
    assert last == direction * end
    assert set(signs) == {signs[0]} and signs[0] != 0.0
