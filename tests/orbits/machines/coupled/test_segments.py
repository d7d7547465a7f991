"""Pieces of segments: positions, works and energies, against the matrix exponential and quadrature."""

import numpy as np
import pytest
from scipy.integrate import simpson

from orbits.machines.reference.machine import reference
from tests.orbits.machines.coupled.motion import path

SEGMENTS = reference("coupled")
PARAMS = np.array(
    [2.1, 0.97, 0.8, 0.15, 0.7, 0.4, 0.3, 0.6, 0.15]
)  # forcing, frequency, damping, mass ratio, r, mu, g, excitation, slope
START = {"psi": 0.9, "w": 0.25, "v": 0.3, "v_rate": -0.2}


def state_of(mode):
    w_rate = 0.4 * mode
    state = np.array([START["psi"], START["w"], w_rate, mode, 0.0, 0.0, START["v"], START["v_rate"]])
    return state, (START["psi"], START["w"], w_rate, START["v"], START["v_rate"])


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("ahead", [0.004, 0.7, 4.0])
def test_positions_and_velocities(mode, ahead):
    state, numbers = state_of(mode)
    out = np.empty((1, 4))
    SEGMENTS.sample(state[None], PARAMS, np.array([ahead]), out)
    eps = PARAMS[3]
    q1, p1, q2, p2 = path(PARAMS, mode, *numbers, ahead / PARAMS[1], 7)[0][-1, :4]
    assert out[0] == pytest.approx([q1 - q2, p1 - p2, q1 + eps * q2, p1 + eps * p2], abs=1e-13)


@pytest.mark.parametrize("mode", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("ahead", [0.3, 1.3])
def test_works_are_integrals_and_balance_the_energy(mode, ahead):
    """Of the excitation eps G (sin + chi eps lambda Omega cos) q1', of the damper eps lambda q1'^2, of friction eps mu g abs(w')."""
    G, Omega, lam, eps, _, mu, g, chi, slope = PARAMS
    state, numbers = state_of(mode)
    works, energies = np.empty((1, 3)), np.empty(2)
    SEGMENTS.works(state[None], PARAMS, np.array([ahead]), works)
    tau = np.linspace(0.0, ahead / Omega, 2001)
    states, *_ = path(PARAMS, mode, *numbers, tau[-1], 2000)
    force = eps * G * (states[:, 4] + chi * eps * lam * Omega * states[:, 5])
    speed = states[:, 1] - states[:, 3]
    assert np.all(mode * speed >= 0.0)  # one direction only
    expected = [
        simpson(force * states[:, 1], x=tau),
        eps * lam * simpson(states[:, 1] ** 2, x=tau),
        eps * mu * g * np.cos(slope) * simpson(np.abs(speed), x=tau),
    ]
    assert works[0] == pytest.approx(expected, abs=1e-11)
    ends = np.zeros((2, 8))
    for row, (q1, p1, q2, p2) in zip(ends, states[[0, -1], :4]):
        row[1], row[2], row[6], row[7] = q1 - q2, p1 - p2, q1 + eps * q2, p1 + eps * p2
    SEGMENTS.energies(ends, PARAMS, energies)
    height = states[0, 0] - states[0, 2]
    assert energies[0] == pytest.approx(
        0.5 * (states[0, 1] ** 2 + states[0, 0] ** 2 + eps * states[0, 3] ** 2)
        + eps * g * np.sin(slope) * height
    )
    assert energies[1] - energies[0] == pytest.approx(expected[0] - expected[1] - expected[2], abs=1e-11)
