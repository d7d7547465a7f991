"""What is stable in regions of a chart: motions of a graph that are carried to another place of the plane, and what simulation finds."""

import numpy as np
import pytest

import contvines as cv
from contvines.loci.regions import KnownMotions
from tests.contvines.loci.systems import bazykin, henon


def test_a_cycle_whose_period_goes_to_zero_is_no_equilibrium():
    """Bazykin's prey and predator far beyond the Hopf point: Newton's method leads from its cycles to curves that stand still in no time, anywhere.

    There is one stable equilibrium: x = (1 + alpha x) (1 + delta y), y = (1 - x / 100) (1 + alpha x).
    """
    flow = cv.FlowProblem(bazykin, [20.0, 5.5], {"alpha": 0.4, "delta": 0.15})
    graph = cv.diagram(flow, over="alpha", within=(0.05, 1.2), depth=1)
    assert graph.of_kind("hopf")
    known = KnownMotions(graph.branches.values(), [], "delta", ((0.05, 1.2), (0.05, 0.4)))
    for alpha, delta in ((0.75, 0.31), (0.9, 0.2), (0.9, 0.39)):
        carried = [known._carried(start, (alpha, delta)) for start in known.starts]
        found = [motion["u"][:2] for motion in carried if motion is not None]
        near = np.poly1d([alpha, 1.0])
        y = np.poly1d([-0.01, 1.0]) * near
        roots = (near * (1.0 + delta * y) - np.poly1d([1.0, 0.0])).roots
        x = float(roots[np.abs(roots.imag).argmin()].real)
        assert found and np.allclose(found, (x, y(x)), rtol=1e-9)


@pytest.mark.slow
def test_witnesses_name_what_is_stable():
    cycles = cv.MapProblem(henon, [0.6, 0.2], {"a": 0.2, "b": 0.3})
    # doublings at a = 3 (1 - b)^2 / 4 and (1 - b)^2 + (1 + b)^2 / 4
    for a, word in ((0.1, "1-cycle"), (0.5, "2-cycle")):
        assert [m["word"] for m in cycles.simulated_attractors(a)] == [word]
    flow = cv.AlgebraicProblem(lambda u, p: p + u - u**3, [-1.2], 0.0, spectrum="flow")
    both = sorted(m["u"][0] for m in flow.simulated_attractors(0.1))
    roots = sorted(np.roots([-1, 0, 1, 0.1]).real)
    assert both == pytest.approx([roots[0], roots[2]], abs=1e-6)
    assert [m["kind"] for m in flow.simulated_attractors(0.9)] == ["equilibrium"]
    wheel = cv.AlgebraicProblem(
        lambda u, p: [u[1], -u[0] + p * u[1] - u[0] ** 2 * u[1]], [0.0, 0.1], 0.5, spectrum="flow"
    )
    assert [m["kind"] for m in wheel.simulated_attractors(0.5)] == ["oscillation"]
    assert "equilibrium" in [m["kind"] for m in wheel.simulated_attractors(-0.5)]
