"""Invariant circles against closed forms, against plain iteration, and against another simulator."""

import json

import numpy as np
import pytest

import contvines as cv
from contvines.circles.invariance import rotation_number
from tests.contvines.loci.systems import R, generalized_henon, generalized_henon_at
from tests.machines import COUPLED, STRONG

ANGLE, TWIST = 1.1, 0.4
SHEAR = np.array([[1.3, 0.4], [-0.2, 0.8]])


def sheared(sign):
    """Radius r -> r (1 + p - sign r^2), angle -> angle + ANGLE + TWIST r^2, in sheared coordinates."""
    back = np.linalg.inv(SHEAR)

    def f(x, p):
        y = back @ x
        square = y[0] * y[0] + y[1] * y[1]
        c, s = np.cos(ANGLE + TWIST * square), np.sin(ANGLE + TWIST * square)
        return SHEAR @ ((1 + p - sign * square) * np.array([c * y[0] - s * y[1], s * y[0] + c * y[1]]))

    return cv.MapProblem(f, [0.0, 0.0], -0.1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_circles_are_those_of_the_closed_form(sign):
    graph = cv.diagram(sheared(sign), within=(-0.3, 0.3), depth=0)
    found = graph["NS1"].circles(to=0.2 * sign)
    assert len(found) > 5 and found.ended == f"reaches p = {0.2 * sign:g}"
    assert found.rotation == pytest.approx(ANGLE / (2 * np.pi), abs=1e-10)
    for circle in found.circles:
        square = sign * circle.value  # r^2 = p / sign
        assert circle.rotation == pytest.approx((ANGLE + TWIST * square) / (2 * np.pi), abs=1e-9)
        y = circle.at(np.linspace(0, 6, 50)) @ np.linalg.inv(SHEAR).T
        assert (y**2).sum(axis=1) == pytest.approx(square, abs=1e-9)
        # the normal form is exact here: every circle is the image of a round one
        assert circle.predicted == pytest.approx(circle.radius, rel=1e-6)
        assert circle.stable is (sign > 0)
    assert found[-1].value == pytest.approx(0.2 * sign, abs=1e-14)
    if sign > 0:
        assert found[3].simulated == pytest.approx(found[3].rotation, abs=1e-8)


def test_averages_of_a_quasi_periodic_sequence():
    golden = (np.sqrt(5) - 1) / 2
    phases = 2 * np.pi * golden * np.arange(4000)
    z = np.exp(1j * (phases + 0.3 * np.sin(phases)))
    value, error = rotation_number(z, 0.5)
    assert value == pytest.approx(golden, abs=1e-12) and error < 1e-8


@pytest.fixture(scope="module")
def coupled():
    return cv.diagram(COUPLED.orbit("LR", frequency=1.02), over="frequency", within=(1.018, 1.027), depth=0)


@pytest.mark.slow
def test_circles_of_the_coupled_absorber_are_invariant_for_another_simulator(coupled):
    """That of the page's two bodies, whose states w = q1 - q2, v = q1 + eps q2 tell."""
    pytest.importorskip("heyoka")
    from tools.pages.pages import page

    found, machine, eps = coupled["NS1"].circles(to=1.0245), page("coupled"), STRONG["mass_ratio"]
    assert found.coefficient > 0.0 and not any(c.stable for c in found.circles)
    assert found.names == ("w", "w_rate", "v", "v_rate")
    for circle in found.circles[:2]:
        assert circle.radius == pytest.approx(circle.predicted, rel=0.15)
    circle = found[-1]
    section = machine.orbit("LR", frequency=circle.value).problem("frequency").section(circle.value)
    to_bodies = np.kron(np.array([[eps, 1.0], [-1.0, 1.0]]) / (1 + eps), np.eye(2))
    order = [list(machine.states).index(name) for name in ("q1", "v1", "q2", "v2")]
    phases = np.linspace(0.1, 6.0, 5)
    for x, image in zip(circle.at(phases), circle.at(phases + 2 * np.pi * circle.rotation)):
        start = np.zeros(4)
        start[order] = to_bodies @ x
        assert np.linalg.solve(to_bodies, section.step(start)[order]) == pytest.approx(image, abs=1e-7)


@pytest.mark.slow
def test_command_line(coupled, run, tmp_path):
    coupled.save(tmp_path / "response.vines")
    line = "circle response.vines NS1 --to 1.0252 --json --plot circle.png"
    status, out, err = run(*line.split())
    assert status == 0, err
    data = json.loads(out)
    assert data["parameter"] == "frequency" and data["circles"][-1]["value"] == pytest.approx(1.0252)
    assert (tmp_path / "circle.png").exists()
    assert "its Neimark-Sacker points are NS1" in run("circle", "response.vines", "LP7")[2]


def iterated(al, be, v, count):
    """Returns of the generalized Henon map at R = -0.1, shape (count, 2); cut off where they run away."""
    found = np.empty((count, 2))
    for i in range(count):
        v = [v[1], al - be * v[0] - v[1] ** 2 - 0.1 * v[0] * v[1]]
        found[i] = v
        if abs(v[1]) > 5.0:
            return found[:i]
    return found


@pytest.mark.slow
def test_circles_near_a_resonance_end_at_a_homoclinic_orbit_as_iteration_does():
    """Beside R1 of the generalized Henon map: fixed point x^2 (1 - R) + x (1 + be) = al, R1 at x = 2 / (R - 2)."""
    al = generalized_henon_at(2.0)[2] + 0.03
    x = -1.0 + np.sqrt(1.0 + al)  # where be = 1 + R x, too
    problem = generalized_henon([x, x], al, 1.0 + R * x - 3e-4)
    graph = cv.diagram(problem, over="be", within=(1.07, 1.09), depth=0)
    (point,) = graph.of_kind("neimark-sacker")
    assert point.value == pytest.approx(1.0 + R * x, abs=1e-12)
    found = point.circles()
    last = found[-1]
    assert "beside which the motion lingers" in found.ended and last.rotation < 0.5 * found.rotation
    assert last.tail < 3e-3 and max(circle.replay for circle in found.circles) < 1e-4
    # iteration stays on a closed curve before the last circle, and runs away beyond it
    before = found[len(found) // 2]
    assert before.value < last.value
    there = iterated(al, before.value, [x + 1e-3, x], 60_000)
    assert len(there) == 60_000
    dense = before.at(np.linspace(0.0, 2.0 * np.pi, 20_001))
    distance = [np.hypot(*(dense - place).T).min() for place in there[-50:]]
    assert max(distance) < 1e-4
    beyond = iterated(al, last.value + 1e-4, [x + 1e-3, x], 60_000)
    assert len(beyond) < 60_000
