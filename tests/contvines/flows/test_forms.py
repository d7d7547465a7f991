"""Normal forms of cycles against closed forms."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.flows.shooting import unit_circle

pytestmark = pytest.mark.slow


def twisted(rates, turn, shear):
    """A cycle, the unit circle, beside which the plane across it turns by `turn` times the angle while `rates` act in it."""

    def f(x, p):
        radius, angle = np.sqrt(x[0] ** 2 + x[1] ** 2), np.arctan2(x[1], x[0])
        speed = 1.0 + shear * (radius - 1.0)
        c, s = np.cos(turn * angle), np.sin(turn * angle)
        a, z = radius - 1.0, x[2]
        v, w = rates(c * a + s * z, -s * a + c * z, p)
        # from the frame that turns with the angle back to that at rest
        outward, upward = c * v - s * w - turn * speed * z, s * v + c * w + turn * speed * a
        return [outward * x[0] / radius - speed * x[1], outward * x[1] / radius + speed * x[0], upward]

    return f


@pytest.mark.parametrize("shear", [0.0, 0.4])
def test_a_rotation_in_the_plane_across_the_cycle(shear):
    """z' = (m + i omega) z - z |z|^2 for a period of 2 pi: r -> r - 2 pi r^3, and |z| is r / sqrt 2 with unit vectors."""
    omega = np.sqrt(2.0) / 2.0

    def rates(v, w, p):
        square = v**2 + w**2
        return p.m * v - omega * w - v * square, omega * v + p.m * w - w * square

    flow = cv.FlowProblem(twisted(rates, 0.0, shear), [1.0, 0.0, 0.1], {"m": -0.3})
    point = cv.diagram(flow.attractor(), over="m", within=(-0.4, 0.2))["NS1"]
    assert point.value == pytest.approx(0.0, abs=1e-10)
    angle = (2.0 * np.pi * omega) % (2.0 * np.pi)
    assert abs(point.frequency) == pytest.approx(min(angle, 2.0 * np.pi - angle), abs=1e-9)
    assert point.coefficient == pytest.approx(-4.0 * np.pi, rel=1e-7)
    assert point.criticality == "supercritical"


@pytest.mark.parametrize(("sign", "word"), [(1.0, "supercritical"), (-1.0, "subcritical")])
def test_half_a_turn_in_the_plane_across_the_cycle(sign, word):
    """v' = m v - v^3 in a frame that turns by half a turn: v -> -v (1 - 2 pi v^2)."""

    def rates(v, w, p):
        return p.m * v - sign * v**3, -0.5 * w

    # the frame is that of an angle between -pi and pi: half a turn makes -v of v, and the rates are odd
    flow = cv.FlowProblem(twisted(rates, 0.5, 0.2), [1.0, 0.0, 0.1], {"m": -0.3})
    graph = cv.diagram(flow.cycle(*unit_circle(3)), over="m", within=(-0.4, 0.2), depth=1)
    point = graph["PD1"]
    assert point.value == pytest.approx(0.0, abs=1e-8)
    assert point.criticality == word
    assert point.coefficient == pytest.approx(sign * 2.0 * np.pi, rel=1e-5)


@pytest.mark.parametrize("mirror", [np.diag([1.0, 1.0, -1.0]), None])
@pytest.mark.parametrize("bent", [-1.0, 1.0])
def test_a_pitchfork_of_cycles(mirror, bent):
    """z' = m z + z (bent z^2 + (r^2 - 1) / 2), where r^2 settles on 1 + 0.3 z^2: z -> z + 2 pi (bent + 0.15) z^3, whatever the angle does."""

    def f(x, p):
        square, turn = x[0] ** 2 + x[1] ** 2, 1.0 + 0.2 * x[2] ** 2
        growth = 1.0 - square + 0.3 * x[2] ** 2
        rise = p * x[2] + x[2] * (bent * x[2] ** 2 + 0.5 * (square - 1.0))
        return [growth * x[0] - turn * x[1], turn * x[0] + growth * x[1], rise]

    flow = cv.FlowProblem(f, [1.0, 0.0, 0.0], -0.2, mirror=mirror)
    graph = cv.diagram(flow.cycle(*unit_circle(3)), over="p", within=(-0.25, 0.1), depth=1)
    (point,) = graph.of_kind("branch-point" if mirror is None else "symmetry-breaking")
    assert point.value == pytest.approx(0.0, abs=1e-10)
    assert point.coefficient == pytest.approx(2.0 * np.pi * (bent + 0.15), rel=1e-9)
    assert point.criticality == ("supercritical" if bent < 0.0 else "subcritical")
