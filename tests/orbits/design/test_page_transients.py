"""Transients of declared machines: against solve_ivp, the built-in machine, and the balance of energy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbits import Coupled, Machine, Wall
from orbits.design.page_transients import page_transient
from orbits.design.transients import start_up
from orbits.symbols import cos

LINEAR = Machine(
    name="linear", states=("x", "v"), parameters={"size": 0.3, "omega": 1.1, "damping": 0.05}, phase_rate="omega",
    motion=lambda s, phase, p, c: (s.v, p.size * p.omega * cos(phase) - 2 * p.damping * s.v - s.x),
    energy=lambda s, phase, p: 0.5 * (s.x**2 + s.v**2),
)  # fmt: skip


@pytest.mark.parametrize(("first", "over"), [(0.2, 40.0), (0.9, 0.1)])
def test_a_run_up_is_a_chirp(first, over):
    """The force size Omega(t) cos(phase(t)) with Omega from its first value to 1.1, then constant; the largest sizes are met between samples."""
    seen = page_transient(LINEAR, LINEAR.vector(), run_up_from=first, run_up_time=over, time=60.0)
    rise = (1.1 - first) / over

    def rates(t, x):
        omega, late = min(first + rise * t, 1.1), max(t - over, 0.0)
        phase = 1.1 * late + (first + 0.5 * rise * (t - late)) * (t - late)
        return [x[1], 0.3 * omega * np.cos(phase) - 0.1 * x[1] - x[0]]

    end = over + 60.0
    run = solve_ivp(rates, (0.0, end), [0.0, 0.0], rtol=1e-11, atol=1e-12, max_step=0.05, dense_output=True)
    np.testing.assert_allclose(seen.states["x"], run.sol(seen.times)[0], atol=2e-7)
    assert seen.times[-1] == pytest.approx(end, abs=1e-9)
    dense = np.abs(run.sol(np.linspace(0.0, end, 600_000))).max(axis=1)
    assert list(seen.largest.values()) == pytest.approx(dense, abs=1e-7)


def test_the_built_in_machine_runs_up_as_its_page_starts():
    """Without a run-up worth the name it is the start-up of the native simulation, impacts included, and the bare oscillator is exact."""
    machine = Coupled(
        damping=2.0, mass_ratio=0.02, restitution=0.6, friction=0.05, gravity=0.3, slope=0.1, excitation=0.5
    )
    params = machine.vector({"forcing": 3.0, "frequency": 1.0})
    plain = start_up(machine, params, periods=20)
    seen = start_up(machine, params, periods=20, run_up=(1.0, 2.0 * np.pi))
    count = np.searchsorted(plain.impact_times, 15 * 2 * np.pi)
    for name in ("impact_times", "impact_speeds"):
        np.testing.assert_allclose(getattr(seen, name)[:count], getattr(plain, name)[:count], atol=1e-6)
    bare = np.interp(plain.times, seen.times, seen.bare)
    np.testing.assert_allclose(bare, plain.bare, atol=5e-3)  # between samples


def test_a_bouncing_ball_takes_its_energy_in_powers():
    """Dropped from 1 with r = 0.5: the n-th impact is at sqrt(2)(1 + 2(r + ... + r^(n-1))) and leaves r^(2n) of the energy.

    Thrown up at 0.1 it rises to 1.005 and hits the floor at sqrt 2.01.
    """
    ball = Machine(
        name="ball", states=("y", "v"), parameters={"r": 0.5}, motion=lambda s, phase, p, c: (s.v, -1.0),
        contacts=[Wall("B", lambda s, phase, p: s.y, {"v": 1.0}, "r")], energy=lambda s, phase, p: s.y + 0.5 * s.v**2,
    )  # fmt: skip
    seen = page_transient(ball, ball.vector(), {"y": 1.0}, time=3.0)
    times = np.sqrt(2.0) * np.array([1.0, 2.0])
    np.testing.assert_allclose(seen.impact_times[:2], times, rtol=1e-10)
    np.testing.assert_allclose(seen.impulses[:2], 1.5 * np.sqrt(2.0) * np.array([1.0, 0.5]), rtol=1e-10)
    shares = [seen.share(time) for time in (*(times + 0.1), times[0] - 0.1)]
    assert shares == pytest.approx([0.75, 0.9375, 0.0])
    thrown = page_transient(ball, ball.vector(), {"y": 1.0, "v": 0.1}, time=3.0)
    assert thrown.largest == pytest.approx({"y": 1.005, "v": np.sqrt(2.01)}, rel=1e-9)
