"""Transients: free decay and recorded base motions, against closed forms, an energy balance and another integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from contvines.core.library import native
from orbits import Absorber, Coupled
from orbits.design import record
from orbits.design.record import recorded
from orbits.design.transients import free_decay, taken_share
from orbits.machines.base import ParameterError

MACHINE = Coupled(restitution=0.6, friction=0.1, gravity=0.25, mass_ratio=0.02, damping=1.5, forcing=0.0)


def pulse(t):
    return 0.8 * np.sin(t) * np.exp(-(((t - 12.0) / 8.0) ** 2))


def test_a_free_decay_balances_and_beats_the_bare_oscillator():
    decay = free_decay(MACHINE, MACHINE.vector(), 3.0)
    lost = decay.impacts + decay.friction + decay.damping
    assert lost == pytest.approx(0.5 * 9.0 * (1.0 - decay.energy[-1]) + 0.5 * 0.0, rel=0.05)
    assert decay.pumping_time < decay.bare_time and 0.05 < decay.absorber_share < 0.6
    rate = MACHINE.mass_ratio * MACHINE.damping
    assert decay.bare_time == pytest.approx(np.log(10.0) / rate, rel=1e-12)
    bare = solve_ivp(
        lambda t, y: [y[1], -rate * y[1] - y[0]],
        (0.0, 60.0),
        [1.0, 0.0],
        rtol=1e-10,
        atol=1e-12,
        dense_output=True,
    )
    t = decay.times[decay.times < 60.0]
    np.testing.assert_allclose(decay.bare[: t.size], (bare.sol(t) ** 2).sum(axis=0), rtol=1e-6)


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
    left = 0.5 * (y[0] ** 2 + y[2] ** 2 + eps * y[3] ** 2) / 4.5
    assert free_decay(machine, machine.vector(), 3.0).energy[2] == pytest.approx(left, abs=1e-9)
    assert taken_share(machine, machine.vector(), 3.0, end) == pytest.approx(
        1.0 - left - y[4] / 4.5, abs=1e-9
    )
    with pytest.raises(ParameterError, match="the slow flow is that of level cavities"):
        machine.orbit_near(None)  # pyright: ignore[reportArgumentType]


def test_a_recorded_motion_of_the_bare_oscillator():
    t = np.linspace(0.0, 40.0, 401)
    a = pulse(t)
    seen = recorded(MACHINE, MACHINE.vector(), t, a)
    rate = MACHINE.mass_ratio * MACHINE.damping
    # between two samples the force is a straight line: with its value and its slope the state obeys a linear equation
    step = t[1] - t[0]
    way = expm(step * np.array([[0, 1, 0, 0], [-1, -rate, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]]))
    known = np.zeros((len(t), 2))
    for k, slope in enumerate(np.diff(a) / step):
        known[k + 1] = (way @ [*known[k], a[k], slope])[:2]
    np.testing.assert_allclose(np.interp(t, seen.times, seen.bare), known[:, 0], atol=2e-3)
    assert seen.bare[-1] == pytest.approx(known[-1, 0], abs=1e-11)


def test_what_goes_in_is_kept_or_lost():
    """The work of the base's acceleration on both masses is what is lost and what they still have."""
    t = np.linspace(0.0, 60.0, 6001)
    a = pulse(t)
    seen = recorded(MACHINE, MACHINE.vector(), t, a)
    assert len(seen.impact_times) > 5 and np.all(np.diff(seen.impact_times) > 0.0)
    assert np.abs(seen.relative).max() <= 1.0 + 1e-9
    assert seen.impacts > 0.0 and seen.friction > 0.0
    assert seen.peak < seen.bare_peak


def test_bad_records_get_a_sentence():
    p = MACHINE.vector()
    for t, a, says in (
        ([0.0, 1.0], [0.0], "two columns of equal length"),
        ([0.0, 0.0], [0.0, 1.0], "do not grow at row 1"),
        ([0.0, np.nan], [0.0, 1.0], "not finite"),
    ):
        with pytest.raises(ParameterError, match=says):
            recorded(MACHINE, p, np.array(t), np.array(a))
    with pytest.raises(ParameterError, match="no oscillator"):
        recorded(
            Absorber(restitution=0.6, friction=0.1, gravity=0.2), np.zeros(6), np.arange(3.0), np.zeros(3)
        )
    with pytest.raises(ParameterError, match="other than 0"):
        free_decay(MACHINE, p, 0.0)


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_impacts_that_pile_up_end_in_contact(friction):
    """Under a constant acceleration A both masses hang on the spring at last: x1 = -(1 + eps) A, the absorber on the left wall."""
    machine = MACHINE.changed(friction=friction, damping=5.0)
    t = np.linspace(0.0, 600.0, 601)
    seen = recorded(machine, machine.vector(), t, np.full(601, 3.0))
    assert seen.oscillator[-1] == pytest.approx(-3.0 * 1.02, abs=1e-9)
    assert seen.relative[-1] == pytest.approx(1.0, abs=1e-9)
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
    np.testing.assert_allclose(one.impact_times, other.impact_times, rtol=1e-8)
    for name in ("times", "oscillator", "relative", "bare", "impacts", "friction", "damping"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), atol=1e-7)
