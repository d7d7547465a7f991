"""Pieces of segments: positions, works and energies, against the matrix exponential and quadrature."""

import numpy as np
import pytest

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
