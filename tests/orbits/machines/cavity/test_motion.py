"""Motion, works and energies in an inclined cavity, against quadrature of w'' = -C Omega^2 sin Psi - b - s a_s."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, simpson

from orbits.machines.reference.law import Law, Response
from orbits.machines.reference.machine import Reference

C, OMEGA, B = 0.8, 1.3, 0.12
A = {1.0: 0.21, -1.0: 0.34}  # friction's accelerations to the left and to the right wall
FREE = Response(C, 0.0, 0.0, OMEGA)
LAW = Law(OMEGA, A[1.0], A[-1.0], B, 0.7, 0.6, 1.2, -0.7, FREE, FREE, 0.0, 0.0, 0.0, 0.0, prescribed=True)
MOTION, NONE = Reference("cavity"), np.zeros(0)
MOTION.law_of = lambda numbers: LAW


def quadrature(psi, w, rate, mode, ahead, count=4000):
    tau = np.linspace(0.0, ahead / OMEGA, count + 1)
    shake = -C * OMEGA**2 * np.sin(psi + OMEGA * tau)
    acceleration = (shake - B - mode * A.get(mode, 0.0)) * (mode != 0.0)
    speed = rate + cumulative_simpson(acceleration, x=tau, initial=0.0)
    return tau, shake, w + cumulative_simpson(speed, x=tau, initial=0.0), speed


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("ahead", [1e-3, 0.4, 2.0])
def test_positions_and_velocities(mode, ahead):
    psi, w, rate = 0.9, 0.25, 1.1 * mode
    out = np.empty((1, 4))
    MOTION.sample(np.array([[psi, w, rate, mode, 0.0, 0.0]]), NONE, np.array([ahead]), out)
    _, _, path, speed = quadrature(psi, w, rate, mode, ahead)
    end = psi + ahead
    assert out[0] == pytest.approx([path[-1], speed[-1], C * np.sin(end), C * OMEGA * np.cos(end)], abs=1e-11)


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("ahead", [0.3, 1.1])
def test_works_and_their_balance(mode, ahead):
    """The shaking works with -C Omega^2 sin Psi on the relative motion, friction takes a_s times the way, gravity is a potential."""
    psi, w, rate = 3.9, 0.25, 1.6 * mode
    works, energies = np.empty((1, 3)), np.empty(2)
    MOTION.works(np.array([[psi, w, rate, mode, 0.0, 0.0]]), NONE, np.array([ahead]), works)
    tau, shake, path, speed = quadrature(psi, w, rate, mode, ahead)
    assert np.all(mode * speed >= 0.0)
    friction = A.get(mode, 0.0) * abs(path[-1] - w)
    assert works[0] == pytest.approx([simpson(shake * speed, x=tau), 0.0, friction], abs=1e-10)
    ends = np.zeros((2, 6))
    ends[:, 1], ends[:, 2] = path[[0, -1]], speed[[0, -1]]
    MOTION.energies(ends, NONE, energies)
    assert energies[0] == pytest.approx(0.5 * rate**2 + B * w)
    assert energies[1] - energies[0] == pytest.approx(works[0, 0] - works[0, 2], abs=1e-10)
