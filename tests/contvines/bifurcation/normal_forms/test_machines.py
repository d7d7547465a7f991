"""Cubic coefficients of machines, distinguished from outside: by the branch that leaves, and by the multiplier of the motion that it leaves."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from tests.machines import ABSORBER, COUPLED, absorber_graph

pytestmark = pytest.mark.slow


def first_node_apart(problem, u):
    """Half the distance between the first event and the one that would be the same one without the bifurcation, in the problem's units."""
    nodes = problem.expand(u)
    later = nodes[len(nodes) // 2].copy()
    later[0] -= np.pi * problem.periods
    if problem.periods % 2:  # its mirror image half a period later
        later[1:] *= -1.0
    return float(np.linalg.norm((nodes[0] - later) / problem.equations.unit[0])) / 2


@pytest.fixture(scope="module")
def graphs():
    return {
        ABSORBER: absorber_graph(0.7, (0.6, 1.16)),
        COUPLED: cv.diagram(
            COUPLED.orbit("LR", frequency=1.01), over="frequency", within=(0.999, 1.02), depth=1
        ),
    }


@pytest.mark.parametrize(
    ("machine", "label"), [(ABSORBER, "SB1"), (ABSORBER, "PD1"), (ABSORBER, "PD2"), (COUPLED, "SB1")]
)
def test_the_branch_that_leaves_has_the_size_that_the_coefficient_says(graphs, machine, label):
    """c of x -> m x + c x^3, whose motion of two returns lies at x^2 = (-1 - m) / c, from the branch that leaves."""
    graph = graphs[machine]
    point = graph[label]
    problem, n = point.problem, len(point.u)
    (child,) = [b for b in graph if b.seed == label and b.points.shape[1] == 2 * n]
    near = (point.value - 0.1, point.value + 0.1)
    root, side = Engine(problem, near, Settings()), Engine(child.problem, near, Settings())
    sizes, ratios = [], []
    for i in np.argsort(np.abs(child.values - point.value))[1:60]:
        p = float(child.values[i])
        solved, leaving = root.at_value(point.u, p), side.at_value(child.points[i], p)
        if solved is None or leaving is None:
            continue
        spectrum = root.spectrum(solved.row)
        m = spectrum[np.argmin(np.abs(spectrum + 1.0))].real
        x = first_node_apart(child.problem, leaving.u)
        if x > 1e-3 / np.sqrt(abs(point.coefficient)):
            sizes.append(x * x)
            ratios.append((-1.0 - m) / (x * x))
    assert point.coefficient == pytest.approx(np.polyfit(sizes[:5], ratios[:5], 2)[-1], rel=1e-5)
