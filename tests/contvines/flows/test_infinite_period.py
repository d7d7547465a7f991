"""Where the period of cycles grows without bound, in flows whose limits are known in closed form."""

import numpy as np
import pytest

import contvines as cv
from contvines.flows.infinite_period import Limit, infinite_period


def limit_of(graph):
    (end,) = graph.of_kind("homoclinic")
    return end, infinite_period(end.problem, end)


def test_a_loop_of_one_saddle_is_homoclinic_and_a_loop_of_two_heteroclinic():
    """With H = y^2 / 2 + V(x), x' = y, y' = -V'(x) - (H - E + m) y has the cycle H = E - m; E is the height of the saddles."""

    def on(height, potential, force):
        def rates(x, p):
            energy = x[1] ** 2 / 2 + potential(x[0])
            return [x[1], force(x[0]) - (energy - height + p.m) * x[1]]

        flow = cv.FlowProblem(rates, [0.0, 0.0], {"m": 0.3}, settings={"homoclinic": 1e-5})
        return cv.diagram(flow, over="m", within=(-0.1, 0.35))

    one = on(1 / 6, lambda x: x**2 / 2 - x**3 / 3, lambda x: x**2 - x)
    two = on(1 / 4, lambda x: x**2 / 2 - x**4 / 4, lambda x: x**3 - x)
    end, limit = limit_of(one)
    assert end.value == pytest.approx(0.0, abs=1e-8) and limit.limit is Limit.HOMOCLINIC
    assert "homoclinic to the saddle at (1, 0) with eigenvalues -1, 1;" in end.note
    # another phase
    end.tangent[: end.problem.states] += 1e6 * end.problem.field(end.orbit.states[:-1], end.value).ravel()
    assert infinite_period(end.problem, end).limit is Limit.HOMOCLINIC
    end, limit = limit_of(two)
    assert end.value == pytest.approx(0.0, abs=1e-8) and limit.limit is Limit.HETEROCLINIC
    places = [saddle.place.tolist() for saddle in limit.saddles]
    assert np.allclose(sorted(places), [[-1.0, 0.0], [1.0, 0.0]], atol=1e-6)
    assert [saddle.share for saddle in limit.saddles] == pytest.approx([0.5, 0.5], abs=1e-3)
    assert "heteroclinic cycle of the saddle at" in end.note and "(-1, 0)" in end.note


def test_two_coupled_oscillators_whose_common_rotation_stands_still():
    """z1' = (1 + 0.4 i - |z1|^2) z1 + k (z2 - z1), z2' = (0.5 - 0.5 i - |z2|^2) z2 + k (z1 - z2): the locked rotation is 0.4 |z1|^2 = 0.5 |z2|^2 at rest,

    which with the equations of the amplitudes is 0.8 k^2 = 0.16 + (2 / 3 + 4 / 9 k)^2.
    """
    at_rest = max(np.roots([0.8 - 16 / 81, -16 / 27, -0.16 - 4 / 9]))

    def rates(x, p):
        a, b, c, d = x
        one, two = 1.0 - a * a - b * b, 0.5 - c * c - d * d
        return [
            one * a - 0.4 * b + p.k * (c - a),
            one * b + 0.4 * a + p.k * (d - b),
            two * c + 0.5 * d + p.k * (a - c),
            two * d - 0.5 * c + p.k * (b - d),
        ]

    flow = cv.FlowProblem(rates, [0.9, 0.1, 0.8, 0.3], {"k": 1.2})
    graph = cv.diagram(flow.attractor(), over="k", within=(1.0, 4.0))
    end, limit = limit_of(graph)
    assert limit.limit is Limit.AT_REST and limit.value == pytest.approx(at_rest, abs=1e-5)
    assert abs(end.value - at_rest) < 1.1 * end.location_error
    assert "comes to rest as a whole" in end.note
    assert {point.kind for point in graph.special.values()} == {"end", "homoclinic"}
    assert not graph.unresolved and graph["B1"].stable.all()


def round_the_circle(x, p):
    """angle' = w - sin(angle) on the unit circle: the period is 2 pi / sqrt(w^2 - 1)."""
    turn, inward = p.w - x[1], 1.0 - x[0] ** 2 - x[1] ** 2
    return [inward * x[0] - turn * x[1], inward * x[1] + turn * x[0]]


@pytest.mark.parametrize(
    ("settings", "exact"),
    [({}, 1.0), ({"longest": 10.0}, np.sqrt(1.0 + 3.0 / 100.0))],  # w^2 - 1 = 3 at the start
)
def test_a_saddle_node_on_the_circle_ends_a_branch(settings, exact):
    """Or the longest period, as a multiple of that of the start."""
    orbit = cv.FlowProblem(round_the_circle, [1.0, 0.0], {"w": 2.0}, settings=settings).attractor()
    graph = cv.diagram(orbit, over="w", within=(0.5, 3.0), depth=0)
    branch, (end,) = graph["B1"], graph.of_kind("homoclinic")
    inner = branch.values > end.value + 1e-9
    periods = 2.0 * np.pi / np.sqrt(branch.values[inner] ** 2 - 1.0)
    assert np.abs(branch.measure("period")[inner] / periods - 1.0).max() < 1e-9
    assert abs(end.value - exact) < (1e-8 if settings else end.location_error)
    if not settings:
        assert end.note.startswith("saddle-node on the cycle")
