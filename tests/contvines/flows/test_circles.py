"""Tori of flows: invariant circles of return maps.

Langford's system without the term that breaks its symmetry: r' = (z - lambda) r, z' = a + z - z^3/3 - r^2 (1 + rho z), phi' = w. Its cycle is an equilibrium of
(r, z), its torus a cycle of (r, z) with period T: the rotation number is that of (2 pi / w) / T turns per return.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
from tests.contvines.flows.shooting import cycle

A, RHO, W = 0.6, 0.25, 3.5


def planar(x, p):
    """z and r."""
    z, r = x
    return [A + z - z**3 / 3 - r * r * (1 + RHO * z), (z - p.q) * r]


def langford(x, p):
    height, growth = planar([x[2], np.sqrt(x[0] ** 2 + x[1] ** 2)], p)[0], x[2] - p.q
    return [growth * x[0] - W * x[1], W * x[0] + growth * x[1], height]


def radius(z):
    return np.sqrt((A + z - z**3 / 3) / (1 + RHO * z))


def birth():
    return brentq(lambda z: 1 - z * z - RHO * radius(z) ** 2, 0.3, 1.0)


@pytest.mark.slow
def test_a_torus_of_langfords_system():
    flow = cv.FlowProblem(langford, [0.8, 0.0, 0.9], {"q": 0.95}, states=("x", "y", "z"))
    graph = cv.diagram(flow.attractor(q=0.95), over="q", within=(0.8, 1.0))
    (point,) = graph.of_kind("neimark-sacker")
    assert point.value == pytest.approx(birth(), abs=1e-10)
    found = point.circles(count=1)
    last = found.circles[-1]
    assert last.value < point.value and last.stable and last.replay < 1e-7
    turns = last.rotation % 1.0
    turns = min(turns, 1.0 - turns)
    start = [last.value, radius(last.value) + last.radius]
    period, _ = cycle(planar, start, (2 * np.pi / W) / turns, q=last.value)
    assert (2 * np.pi / W) / period == pytest.approx(turns, abs=1e-8)
    # close to its birth the torus has the size that the normal form says
    assert found.circles[0].radius == pytest.approx(found.circles[0].predicted, rel=1e-3)
    assert set(found.names) < {"x", "y", "z"}
