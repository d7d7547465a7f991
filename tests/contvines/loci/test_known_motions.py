"""Motions of a graph that are carried to another place of the plane."""

import numpy as np

import contvines as cv
from contvines.loci.regions import KnownMotions
from tests.contvines.loci.systems import bazykin


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
