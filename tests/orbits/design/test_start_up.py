"""Start-up against an ODE solver: the bare oscillator as it is, and the machine until its first impact."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbits import Coupled
from orbits.design.transients import start_up

MACHINE = Coupled(damping=2.0, mass_ratio=0.02, restitution=0.6, friction=0.05, gravity=0.3)


@pytest.mark.parametrize("frequency", [0.8, 1.0, 1.3])
def test_the_bare_oscillator_starts_as_an_ode_solver_says(frequency):
    params = MACHINE.vector({"forcing": 3.0, "frequency": frequency})
    seen = start_up(MACHINE, params, periods=8)

    def rates(t, x):
        base, speed = 0.06 * np.sin(frequency * t), 0.06 * frequency * np.cos(frequency * t)
        return [x[1], base + 0.04 * speed - 0.04 * x[1] - x[0]]

    told = solve_ivp(rates, (0.0, seen.times[-1]), [0.0, 0.0], t_eval=seen.times, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(seen.bare, told.y[0], atol=1e-9)


def test_the_energy_that_is_taken_and_the_impacts():
    params = MACHINE.vector({"forcing": 3.0, "frequency": 1.0})
    seen = start_up(MACHINE, params)
    assert seen.impact_times.size > 20 and seen.impact_speeds.min() >= 0.0
    assert np.abs(seen.relative).max() <= 1.0 + 1e-9  # the walls
    assert 0.0 < seen.absorber_share < 1.0
    assert np.abs(seen.oscillator).max() < np.abs(seen.bare).max()


def test_the_last_periods_are_those_of_the_attractor():
    params = MACHINE.vector({"forcing": 3.0, "frequency": 1.0})
    seen = start_up(MACHINE, params, periods=400)
    settled = MACHINE.attractor(forcing=3.0, frequency=1.0)
    last = np.abs(seen.oscillator[-10 * 80 :]).max()  # at 80 instants a period
    np.testing.assert_allclose(last, settled.found.measure("max_abs_q1"), rtol=2e-3)
    assert 0.0 < seen.settled < seen.times[-1]
