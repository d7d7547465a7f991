"""Meshes that move along: the same curve, nodes that stay where the motion is; cycles whose jumps move."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contvines as cv
from contvines.flows import mesh
from contvines.flows.mesh import rule
from contvines.flows.moving_mesh import MovingMesh

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


def test_nodes_go_with_a_jump_and_stay_where_the_whole_range_grows():
    widths = np.full(80, 1.0 / 80)
    places = mesh.node_places(RULE, widths)
    x = on_mesh(widths, curve(places))
    shifted = on_mesh(widths, (curve(places, 1e-6) - curve(places, -1e-6)) / 2e-6)
    dx, dw = steered(widths, x, shifted)
    assert np.abs(dx).max() < 0.01 * np.abs(shifted).max() and np.abs(dw / widths).max() < 0.01
    grown = on_mesh(widths, curve(places, height=2.0) - curve(places))
    dx, dw = steered(widths, x, grown)
    assert np.allclose(dx, grown, atol=1e-9) and np.abs(dw / widths).max() < 1e-9


def test_the_mesh_goes_on_alike_where_two_equal_parts_change_places():
    """A curve that goes twice round, with what tells the rounds apart on either side of nothing: half the step between both is what it does at nothing."""
    widths = np.full(80, 1.0 / 80)
    places = mesh.node_places(RULE, widths)
    twice, apart = curve(2.0 * places), np.sin(2.0 * np.pi * places)[:, None] * np.array([0.3, 1.0])
    found = [
        np.concatenate(
            [part.reshape(-1) for part in steered(widths, on_mesh(widths, x), on_mesh(widths, apart), 2)]
        )
        for x in (twice - 1e-6 * apart, twice, twice + 1e-6 * apart)
    ]
    assert np.abs(found[2] - found[0]).max() < 1e-4 * np.abs(found[1]).max()


@pytest.mark.slow
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
        y = f * x / (q + x)
        first = [(1.0 - y - 2.0 * x) / fast, (q - x) / fast, 0.0]
        values = np.linalg.eigvals([first, [-y / faster, -(q + x) / faster, f / faster], [1.0, 0.0, -1.0]])
        return values[np.argmax(values.real)].real

    flow = cv.FlowProblem(rates, [0.7, 0.3, 0.7], {"f": 0.3})
    graph = cv.diagram(flow, over="f", within=(0.3, 3.0), progress=False)
    hopf = sorted(point.value for point in graph.of_kind("hopf"))
    assert hopf == pytest.approx(
        [brentq(growth, 0.4, 0.6, xtol=1e-13), brentq(growth, 2.2, 2.6, xtol=1e-13)], abs=1e-8
    )
    assert not graph.of_kind("homoclinic") and len(graph.branches) == 2
    assert not graph.branches["B2"].closed  # the mesh becomes too coarse with the first points
    assert all(gap.high - gap.low < 1e-9 for gap in graph.unresolved)


def test_rest_has_no_fast_parts_and_doubles_at_the_edges_of_mathieus_tongue():
    """Edges of the first tongue: det(M + 1) = 0, with M integrated by scipy, or, to first order in the excitation e, near 2 -+ e / 2."""
    damping, excitation = 0.05, 0.5

    def variations(t, y, w):
        stiffness = 1.0 + excitation * np.cos(w * t)
        return [
            y[2],
            y[3],
            -2 * damping * y[2] - stiffness * y[0],
            -2 * damping * y[3] - stiffness * y[1],
        ]

    def doubles(w):
        end = solve_ivp(variations, (0.0, 2 * np.pi / w), [1, 0, 0, 1], args=(w,), rtol=1e-11, atol=1e-12)
        return np.linalg.det(end.y[:, -1].reshape(2, 2) + np.eye(2))

    flow = cv.FlowProblem(
        lambda x, p, t: [
            x[1],
            -2 * damping * x[1] - (1.0 + excitation * np.cos(p.w * t)) * x[0] - x[0] ** 3,
        ],
        [0.0, 0.0],
        {"w": 2.6},
        period=lambda p: 2 * np.pi / p.w,
        mirror=lambda x: -x,
    )
    graph = cv.diagram(flow, over="w", within=(1.5, 2.6), depth=0, progress=False)
    found = sorted(point.value for point in graph.of_kind("period-doubling"))
    assert found == pytest.approx([brentq(doubles, 1.6, 1.9), brentq(doubles, 2.1, 2.4)], abs=1e-8)
    assert graph.branches["B1"].values.min() == 1.5 and graph.branches["B1"].values.max() == 2.6
