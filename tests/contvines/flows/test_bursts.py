"""Bursts of spikes are cycles like others."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv


@pytest.mark.slow
def test_a_burst_of_sharp_spikes_is_a_cycle():
    """Hindmarsh's and Rose's neuron: DOP853 comes back to its state after the period."""

    def rates(x, p):
        return [
            x[1] - x[0] ** 3 + 3 * x[0] ** 2 - x[2] + p.current,
            1 - 5 * x[0] ** 2 - x[1],
            0.01 * (4 * (x[0] + 1.6) - x[2]),
        ]

    flow = cv.FlowProblem(rates, [-1.5, -10.0, 0.0], {"current": 2.0})
    orbit = flow.attractor()
    values = SimpleNamespace(current=2.0)
    settled = solve_ivp(
        lambda t, y: rates(y, values), (0.0, 4000.0), [-1.5, -10.0, 0.0], method="DOP853", rtol=1e-10
    ).y[:, -1]
    later = solve_ivp(
        lambda t, y: rates(y, values), (0.0, orbit.period), settled, method="DOP853", rtol=1e-10
    ).y[:, -1]
    assert orbit.stable and np.abs(later - settled).max() < 1e-4
