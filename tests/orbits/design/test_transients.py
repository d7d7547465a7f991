"""Transients: start-up, free decay and recorded base motions, against closed forms, an energy balance and another integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from contvines.core.library import native
from orbits import Coupled
from orbits.design import record
from orbits.design.record import recorded
from orbits.design.transients import free_decay, start_up, taken_share
from orbits.machines.base import ParameterError
from tests.machines import ABSORBER

MACHINE = Coupled(restitution=0.6, friction=0.1, gravity=0.25, mass_ratio=0.02, damping=1.5, forcing=0.0)
STARTED = MACHINE.changed(friction=0.05, gravity=0.3, damping=2.0, forcing=3.0)


@pytest.mark.parametrize("frequency", [0.8, 1.0, 1.3])
def test_the_bare_oscillator_starts_as_an_ode_solver_says(frequency):
    seen = start_up(STARTED, STARTED.vector({"frequency": frequency}), periods=8)

    def rates(t, x):
        base, speed = 0.06 * np.sin(frequency * t), 0.06 * frequency * np.cos(frequency * t)
        return [x[1], base + 0.04 * speed - 0.04 * x[1] - x[0]]

    told = solve_ivp(rates, (0.0, seen.times[-1]), [0.0, 0.0], t_eval=seen.times, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(seen.bare, told.y[0], atol=1e-9)


def test_the_last_periods_of_a_start_up_are_those_of_the_attractor():
    seen = start_up(STARTED, STARTED.vector({"frequency": 1.0}), periods=400)
    settled = STARTED.attractor(frequency=1.0)
    last = np.abs(seen.oscillator[-10 * 80 :]).max()  # at 80 instants a period
    np.testing.assert_allclose(last, settled.found.measure("max_abs_q1"), rtol=2e-3)
    assert 0.0 < seen.settled < seen.times[-1] and 0.0 < seen.absorber_share < 1.0


def test_a_free_decay_balances_and_beats_the_bare_oscillator():
    decay = free_decay(MACHINE, MACHINE.vector(), 3.0)
    lost = decay.impacts + decay.friction + decay.damping
    assert lost == pytest.approx(0.5 * 9.0 * (1.0 - decay.energy[-1]), rel=1e-12)
    assert decay.pumping_time < decay.bare_time and 0.05 < decay.absorber_share < 0.6
    rate = MACHINE.mass_ratio * MACHINE.damping
    assert decay.bare_time == pytest.approx(np.log(10.0) / rate, rel=1e-12)
    bare = [expm(t * np.array([[0.0, 1.0], [-1.0, -rate]]))[:, 0] for t in decay.times]
    np.testing.assert_allclose(decay.bare, np.square(bare).sum(axis=1), rtol=1e-9)
    with pytest.raises(ParameterError, match="other than 0"):
        free_decay(MACHINE, MACHINE.vector(), 0.0)


def test_a_free_decay_on_a_slope_is_that_of_newton_s_laws():
    """Without friction: two bodies between impacts, by scipy's DOP853, and the power that the damper takes beside them."""
    machine = MACHINE.changed(friction=0.0, slope=0.2, mass_ratio=0.1)
    eps, rate, pull = 0.1, 0.1 * machine.damping, machine.gravity * np.sin(0.2)

    def laws(t, y):
        return [y[2], y[3], -y[0] - rate * y[2] - eps * pull, pull, rate * y[2] ** 2]

    def wall(t, y):
        return 1.0 - abs(y[0] - y[1])

    wall.terminal, wall.direction = True, -1  # pyright: ignore[reportFunctionMemberAccess]
    y, t, end = np.array([3.0, 3.0, 0.0, 0.0, 0.0]), 0.0, 4.0 * np.pi
    while t < end:
        run = solve_ivp(laws, (t, end), y, method="DOP853", events=wall, rtol=1e-12, atol=1e-13)
        t, y = run.t[-1], run.y[:, -1]
        if run.t_events[0].size:
            jump = (1.0 + machine.restitution) * (y[2] - y[3]) / (1.0 + eps)
            y[2], y[3] = y[2] - eps * jump, y[3] + jump
    left, params = 0.5 * (y[0] ** 2 + y[2] ** 2 + eps * y[3] ** 2) / 4.5, machine.vector()
    assert free_decay(machine, params, 3.0).energy[2] == pytest.approx(left, abs=1e-9)
    assert taken_share(machine, params, 3.0, end) == pytest.approx(1.0 - left - y[4] / 4.5, abs=1e-9)
    with pytest.raises(ParameterError, match="the slow flow is that of level cavities"):
        machine.orbit_near(None)  # pyright: ignore[reportArgumentType]


def test_a_recorded_motion_of_the_bare_oscillator():
    """Between two samples the force is a straight line: with its value and its slope the state obeys a linear equation."""
    t = np.linspace(0.0, 40.0, 401)
    a = 0.8 * np.sin(t) * np.exp(-(((t - 12.0) / 8.0) ** 2))
    seen = recorded(MACHINE, MACHINE.vector(), t, a)
    rate, step = MACHINE.mass_ratio * MACHINE.damping, t[1] - t[0]
    way = expm(step * np.array([[0, 1, 0, 0], [-1, -rate, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]]))
    known = np.zeros((len(t), 2))
    for k, slope in enumerate(np.diff(a) / step):
        known[k + 1] = (way @ [*known[k], a[k], slope])[:2]
    np.testing.assert_allclose(np.interp(t, seen.times, seen.bare), known[:, 0], atol=2e-3)
    assert seen.bare[-1] == pytest.approx(known[-1, 0], abs=1e-11)
    assert len(seen.impact_times) > 5 and np.all(np.diff(seen.impact_times) > 0.0)
    assert np.abs(seen.relative).max() <= 1.0 + 1e-9 and seen.peak < seen.bare_peak


@pytest.mark.parametrize(
    ("machine", "t", "a", "says"),
    [
        (MACHINE, [0.0, 1.0], [0.0], "two columns of equal length"),
        (MACHINE, [0.0, 0.0], [0.0, 1.0], "do not grow at row 1"),
        (MACHINE, [0.0, np.nan], [0.0, 1.0], "not finite"),
        (ABSORBER, [0.0, 1.0], [0.0, 1.0], "no oscillator"),
    ],
)
def test_bad_records_get_a_sentence(machine, t, a, says):
    with pytest.raises(ParameterError, match=says):
        recorded(machine, machine.vector({"amplitude": 1.0} if machine is ABSORBER else {}), t, a)


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_impacts_that_pile_up_end_in_contact(friction):
    """Under a constant acceleration A both masses hang on the spring at last: x1 = -(1 + eps) A, the absorber on the left wall."""
    machine = MACHINE.changed(friction=friction, damping=5.0)
    seen = recorded(machine, machine.vector(), np.linspace(0.0, 600.0, 601), np.full(601, 3.0))
    assert (seen.oscillator[-1], seen.relative[-1]) == pytest.approx((-3.0 * 1.02, 1.0), abs=1e-9)
    assert 10 < seen.impact_times.size < 200


def test_the_native_core_marches_as_its_reference_does(monkeypatch):
    """A noisy record with friction and a long tail, through impacts, sticks and contact with a wall; in slices of a few rows."""
    rng = np.random.default_rng(7)
    t = np.sort(rng.uniform(0.0, 30.0, 120))
    a = rng.normal(0.0, 1.2, t.size)
    machine = Coupled(
        restitution=0.3, friction=0.4, gravity=0.5, mass_ratio=0.1, damping=0.8, forcing=1.0, frequency=1.0
    )
    found = []
    for use in (True, False):
        monkeypatch.setattr(record, "native", lambda use=use: use and native())
        monkeypatch.setattr(record, "SLICE", 7)
        found.append(recorded(machine, machine.vector(), t, a, tail=3.0))
    one, other = found
    assert len(one.impact_times) == len(other.impact_times) > 3
    for name in ("impact_times", "times", "oscillator", "relative", "bare", "impacts", "friction", "damping"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-8, atol=1e-9)
