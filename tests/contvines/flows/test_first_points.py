"""First points of a branch of doubled cycles: so far from the doubling that their parameter tells on which side of it they are."""

from dataclasses import replace

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
