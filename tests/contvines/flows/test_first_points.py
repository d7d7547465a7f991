"""First points of branches of cycles: so far from where they are born that their parameter tells on which side of it they are."""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from tools.flow_demos.listed import DEMOS

pytestmark = pytest.mark.slow
PENDULA = next(demo for demo in DEMOS if demo.name == "pen")


@pytest.mark.parametrize("within", [(0.1788, 0.27), (0.1788, 0.2)])
def test_no_folds_beside_a_doubling(within):
    """The doubling of AUTO's `pen` (0.179163) is subcritical: the doubled cycle is unstable, and goes to where the other one is stable.

    1e-3 (in the metric) beside it the parameter of a solution is known to 3e-11, and differs from that of the doubling by 1e-13.
    """
    flow = replace(PENDULA, p=0.18).flow()
    graph = cv.diagram(flow.attractor(), over="I", within=within, depth=1)
    (doubling,) = graph.of_kind("period-doubling")
    assert doubling.value == pytest.approx(0.179163, abs=1e-6)
    assert doubling.criticality == "subcritical"
    (doubled,) = (branch for branch in graph if branch.seed == doubling.label)
    assert not graph.of_kind("fold") and not graph.unresolved
    assert doubled.stable is not None and not doubled.stable.any()
    assert doubled.values.min() > doubling.value - 2.0 * doubling.location_error


def test_cycles_beside_a_strong_saddle_begin_where_rounding_tells_their_parameter():
    """Roessler's flow of four states (Phys. Lett. A 71 (1979) 155): beside an equilibrium whose motions part by e^33 in a turn.

    The parameter of small cycles is even in their amplitude, so that its change divided by the square of that is constant at first; where it is less
    than rounding makes of it no fold can be told.
    """

    def rates(x, p):
        return [-x[1] - x[2], x[0] + p.a * x[1] + x[3], 3.0 + x[0] * x[2], 0.05 * x[3] - 0.5 * x[2]]

    z = np.sqrt(3.0 / (10.0 - 0.12))
    flow = cv.FlowProblem(rates, [-(10.0 - 0.12) * z, -z, z, 10.0 * z], {"a": 0.12})
    graph = cv.diagram(flow, over="a", within=(0.1, 0.2), depth=1)
    assert {point.kind for point in graph.special.values()} == {"end", "hopf"}
    (born,), cycles = graph.of_kind("hopf"), graph["B2"]
    assert cycles.values.max() == pytest.approx(0.2)
    change = cycles.values - born.value
    first = (change > 1e-9) & (change < 1e-7)
    sizes = np.ptp(cycles.points[first][:, : cycles.problem.states : 4], axis=1)
    assert first.sum() > 5 and np.ptp(change[first] / sizes**2) < 0.02 * (change[first] / sizes**2).max()
