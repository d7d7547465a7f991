"""Motions of a graph that are carried to another place of the plane."""

import numpy as np

import contvines as cv
from contvines.loci.regions import KnownMotions


def test_a_cycle_whose_period_goes_to_zero_is_no_equilibrium():
    """Bazykin's prey and predator far beyond the Hopf point: Newton's method leads from its cycles to curves that stand still in no time, anywhere.

    There is one stable equilibrium: x = (1 + al x) (1 + de y), y = (1 - x / 100) (1 + al x).
    """

    def rates(x, p):
        eaten = x[0] * x[1] / (1 + p.al * x[0])
        return [x[0] - eaten - x[0] ** 2 / 100, -x[1] + eaten - p.de * x[1] ** 2]

    flow = cv.FlowProblem(rates, [20.0, 5.5], {"al": 0.4, "de": 0.15})
    graph = cv.diagram(flow, over="al", within=(0.05, 1.2), depth=1)
    assert graph.of_kind("hopf")
    known = KnownMotions(graph.branches.values(), [], "de", ((0.05, 1.2), (0.05, 0.4)))
    for al, de in ((0.75, 0.31), (0.9, 0.2), (0.9, 0.39)):
        carried = [known._carried(start, (al, de)) for start in known.starts]
        found = [motion["u"][:2] for motion in carried if motion is not None]
        near = np.poly1d([al, 1.0])
        rest = near * (1.0 + de * np.poly1d([-0.01, 1.0]) * near) - np.poly1d([1.0, 0.0])
        roots = np.roots(rest.coef)
        x = float(roots[np.abs(roots.imag).argmin()].real)
        assert found
        assert np.allclose(found, (x, (1.0 - x / 100.0) * (1.0 + al * x)), rtol=1e-9)
