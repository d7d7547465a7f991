"""Meshes that move along: the same curve, nodes that stay where the motion is; cycles whose jumps move."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
from contvines.flows import mesh
from contvines.flows.mesh import rule
from contvines.flows.moving_mesh import MovingMesh
from tests.contvines.flows.shooting import after, jacobian

RULE = rule(4)
PLACES = np.linspace(0.0, 1.0, 701)[:-1]


def curve(t: np.ndarray, shift: np.ndarray | float = 0.0, height: float = 1.0) -> np.ndarray:
    """Two jumps in a period, at moments that may be shifted."""
    s = 2.0 * np.pi * (t - shift)
    return np.column_stack([height * np.tanh(6.0 * np.sin(s)), np.cos(s)])


def steered(widths, x, dx, copies=1, pinned=False):
    """Both cores: nodes and widths of the direction, at a scale of 2 and 0.5."""
    scale, found = np.array([2.0, 0.5]), []
    for compiled in (True, False):
        moving = MovingMesh(RULE, len(widths), 1 - pinned, copies, scale)
        if not compiled:
            moving.record = None
        period = np.ones(moving.free)
        tangent = np.concatenate([dx.reshape(-1), 0.0 * period, 0.0 * widths, [0.0]])
        moving.steer(np.concatenate([x.reshape(-1), period, widths]), tangent)
        found.append(tangent)
    assert np.allclose(*found, rtol=1e-9, atol=1e-10 * np.abs(found[0]).max())
    return found[0][: x.size].reshape(x.shape), found[0][x.size + moving.free : -1]


def on_mesh(widths: np.ndarray, values: np.ndarray) -> np.ndarray:
    return values.reshape(len(widths), RULE.degree, 2)


@pytest.mark.parametrize("copies", [1, 2])
@pytest.mark.parametrize("pinned", [False, True])
def test_the_curve_changes_as_it_would_where_the_mesh_stands_still(copies, pinned):
    part = 1.0 + 0.3 * np.sin(np.arange(80.0 / copies))
    widths = np.tile(part, copies) / (copies * part.sum())
    places = mesh.node_places(RULE, widths)
    x = on_mesh(widths, curve(places))
    # d/ds of curve(t, s / 10 sin(4 pi t)): where it stands, jumps come earlier and later
    exact = (curve(places, 1e-6 * np.sin(4.0 * np.pi * places)) - curve(places)) / 1e-5
    dx, dw = steered(widths, x, on_mesh(widths, exact), copies=copies, pinned=pinned)
    assert dw.sum() == pytest.approx(0.0, abs=1e-12)
    assert np.allclose(dw.reshape(copies, -1), dw.reshape(copies, -1)[0])
    step = 1e-5
    moved = mesh.evaluate(RULE, widths + step * dw, x + step * dx, PLACES)
    still = mesh.evaluate(RULE, widths, x + step * on_mesh(widths, exact), PLACES)
    # the origin of time may be shifted, unless it is pinned
    rates = (curve(PLACES + 1e-6) - curve(PLACES - 1e-6)) / 2e-6
    gap = moved - still
    if not pinned:
        gap -= rates * (rates * gap).sum() / (rates**2).sum()
    assert np.abs(gap).max() < 0.02 * step * np.abs(exact).max()


@pytest.mark.slow
@pytest.mark.long
def test_an_oregonator_from_one_hopf_point_to_the_other():
    """Tyson's scaling (epsilon = 0.01, epsilon' = 1e-4, q = 8e-4), with canards at both ends, the upper one near the equilibrium, but not homoclinic.

    In a window of f as wide as a last bit neither canard can be resolved. Hopf points: complex eigenvalues of a Jacobian written by hand.
    """
    q, fast, faster = 8e-4, 0.01, 1e-4

    def rates(x, p):
        return [
            (q * x[1] - x[0] * x[1] + x[0] * (1.0 - x[0])) / fast,
            (-q * x[1] - x[0] * x[1] + p.f * x[2]) / faster,
            x[0] - x[2],
        ]

    def growth(f):
        x = 0.5 * (1.0 - f - q + np.sqrt((1.0 - f - q) ** 2 + 4.0 * q * (1.0 + f)))
        values = np.linalg.eigvals(jacobian(rates, np.array([x, f * x / (q + x), x]), SimpleNamespace(f=f)))
        return values.real.max()

    flow = cv.FlowProblem(rates, [0.7, 0.3, 0.7], {"f": 0.3})
    graph = cv.diagram(flow, over="f", within=(0.3, 3.0))
    hopf = sorted(point.value for point in graph.of_kind("hopf"))
    assert hopf == pytest.approx(
        [brentq(growth, 0.4, 0.6, xtol=1e-13), brentq(growth, 2.2, 2.6, xtol=1e-13)], abs=1e-8
    )
    assert len(graph.branches) == 2
    cycles = graph.branches["B2"]  # whose mesh becomes too coarse with the first points
    assert [ending.point for ending in cycles.endings] == ["HB1", "HB2"]
    assert {point.kind for point in graph.special.values()} <= {"hopf", "end", "fold"}
    assert all(gap.high - gap.low < 1e-9 for gap in graph.unresolved)


def test_rest_has_no_fast_parts_and_doubles_at_the_edges_of_mathieus_tongue():
    """Edges of the first tongue: det(M + 1) = 0, with M integrated by scipy, or, to first order in the excitation e, near 2 -+ e / 2."""

    def mathieu(x, p, t):
        y = x[0] - 0.3
        return [x[1], -0.1 * x[1] - (1.0 + 0.5 * np.cos(p.w * t)) * y - y**3]

    def doubles(w):
        return np.linalg.det(after(mathieu, [0.3, 0.0], 2 * np.pi / w, w=w)[1] + np.eye(2))

    flow = cv.FlowProblem(
        mathieu, [0.3, 0.0], {"w": 2.6}, period=lambda p: 2 * np.pi / p.w, mirror=lambda x: [0.6, 0.0] - x
    )
    graph = cv.diagram(flow, over="w", within=(1.5, 2.6), depth=0)
    found = sorted(point.value for point in graph.of_kind("period-doubling"))
    assert found == pytest.approx([brentq(doubles, 1.6, 1.9), brentq(doubles, 2.1, 2.4)], abs=1e-8)
    assert graph["B1"].range == (1.5, 2.6) and graph["B1"].problem.intervals == 40
