"""Calibration on data made by another simulator (scipy's integrator with events), with noise."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbits import Coupled
from orbits.design.calibration import fit, from_impacts, from_sweep
from orbits.design.columns import read_columns
from orbits.machines.base import ParameterError

TRUE = {"restitution": 0.63, "friction": 0.12}
REST = {"gravity": 0.25, "mass_ratio": 0.02, "damping": 1.5, "forcing": 6.0, "frequency": 1.0}


def measured_impacts(count, restitution, friction):
    """Impact times of the coupled machine from rest, by solve_ivp: sliding, sticking and impacts as events."""
    eps, lam, G, omega, g = (REST[n] for n in ("mass_ratio", "damping", "forcing", "frequency", "gravity"))
    pull = friction * g

    def inertia(t, y):
        e = eps * G * (np.sin(omega * t) + eps * lam * omega * np.cos(omega * t))
        return (e - y[0] - eps * lam * y[1]) / (1.0 + eps)

    t, y, mode, hits = 0.0, np.zeros(4), 0, []
    while len(hits) < count:

        def rates(t, y, S=mode):
            if S == 0:
                a = inertia(t, y)
                return [y[1], a, y[1], a]
            return [y[1], (1.0 + eps) * inertia(t, y) - eps * pull * S, y[3], pull * S]

        if mode == 0:
            events = [lambda t, y: pull - inertia(t, y), lambda t, y: pull + inertia(t, y)]
        else:
            events = [
                lambda t, y: 1 - y[0] + y[2],
                lambda t, y: 1 + y[0] - y[2],
                lambda t, y, S=mode: S * (y[1] - y[3]),
            ]
        for event in events:
            event.terminal, event.direction = True, -1
        run = solve_ivp(rates, (t, t + 50.0), y, events=events, rtol=1e-10, atol=1e-12)
        t, y = run.t[-1], run.y[:, -1].copy()
        which = next(i for i, found in enumerate(run.t_events) if len(found))
        if mode == 0:
            mode = 1 if which == 0 else -1
        elif which < 2:
            hits.append(t)
            w, v = -restitution * (y[1] - y[3]), y[1] + eps * y[3]
            y[3] = (v - w) / (1.0 + eps)
            y[1] = y[3] + w
            y[2] = y[0] - (1 - 1e-12) * (1 if which == 0 else -1)
            mode = 1 if w > 0 else -1
        else:
            need = inertia(t, y)
            y[3] = y[1]
            mode = 0 if abs(need) <= pull else (1 if need > 0 else -1)
            y[3] -= mode * 1e-12
    return np.array(hits)


def test_restitution_and_friction_from_impact_times():
    times = measured_impacts(25, **TRUE) + np.random.default_rng(1).normal(0.0, 1e-3, 25)
    found = from_impacts(
        Coupled(**TRUE | {"restitution": 0.6, "friction": 0.1} | REST),
        times,
        {"restitution": 0.6, "friction": 0.1},
    )
    for name, value in TRUE.items():
        low, high = found.intervals[name]
        assert low < value < high, str(found)
        assert high - low < 0.05
    assert 4e-4 < found.scatter < 4e-3
    assert "restitution = 0.6" in str(found)


def test_restitution_from_a_sweep():
    """Heights of exact orbits, with noise, through simulated responses."""
    machine = Coupled(**TRUE | REST | {"forcing": 2.0})
    values = np.linspace(1.003, 1.02, 5)
    orbits = [machine.orbit("LR", frequency=f) for f in values]
    assert all(orbit.stable and orbit.real for orbit in orbits)
    heights = np.array([orbit.measure("max_abs_q1") for orbit in orbits])
    noisy = heights + np.random.default_rng(2).normal(0.0, 1e-3, values.size)
    found = from_sweep(
        machine.changed(restitution=0.58), "frequency", values, noisy, {"restitution": 0.58}, transient=150
    )
    low, high = found.intervals["restitution"]
    assert low < TRUE["restitution"] < high and high - low < 0.1


def test_intervals_hold_the_truth_as_often_as_they_say():
    """A straight line with noise: the interval of the slope is that of linear regression."""
    from scipy.stats import linregress, t

    x = np.linspace(0.0, 1.0, 12)
    y = 2.0 * x + 1.0 + np.random.default_rng(5).normal(0.0, 0.1, x.size)
    found = fit(lambda p: p[0] * x + p[1] - y, {"a": 1.0, "b": 0.0}, {"a": (-9, 9), "b": (-9, 9)})
    known = linregress(x, y)
    assert found.values["a"] == pytest.approx(known.slope, rel=1e-7)
    reach = t.ppf(0.975, x.size - 2) * known.stderr
    assert found.intervals["a"] == pytest.approx((known.slope - reach, known.slope + reach), rel=1e-6)


def test_bad_data_get_a_sentence(tmp_path):
    machine = Coupled(**TRUE | REST)
    for times, says in (
        ([0.0, 1.0], "too few impacts"),
        ([0.0, 2.0, 1.0], "do not grow"),
        ([0.0, np.nan, 1.0], "not finite"),
    ):
        with pytest.raises(ParameterError, match=says):
            from_impacts(machine, times, {"restitution": 0.6})
    with pytest.raises(ParameterError, match="nothing is unknown"):
        from_impacts(machine, [0.0, 1.0, 2.0], {})
    with pytest.raises(ParameterError, match="do not depend on b"):
        fit(lambda p: np.arange(3.0) - p[0], {"a": 1.0, "b": 1.0}, {"a": (-5, 5), "b": (0, 2)})
    (tmp_path / "a.csv").write_text("time,acceleration\n0,1\n0.5,x\n")
    with pytest.raises(ParameterError, match="row 3 holds"):
        read_columns(tmp_path / "a.csv", 2)
    (tmp_path / "b.csv").write_text("time,acceleration\n0,1\n0.5,2\n")
    assert read_columns(tmp_path / "b.csv", 2).tolist() == [[0.0, 1.0], [0.5, 2.0]]


@pytest.mark.parametrize("width", [0.0, 3e-7, 4e-6, 3e-5])
def test_a_narrow_window_of_another_motion_at_the_estimate_makes_it_no_surer(width):
    """A straight line through the origin: its slope and the interval in closed form (Student's t with n - 1 degrees of freedom)."""
    from scipy.stats import t

    x = np.linspace(1.0, 2.0, 9)
    data = 0.62 * x + np.random.default_rng(4).normal(0.0, 3e-3, 9)
    slope = float(x @ data / (x @ x))
    rest = data - slope * x
    half = float(t.ppf(0.975, 8)) * np.sqrt(rest @ rest / 8.0 / (x @ x))

    def residuals(p):
        window = 0.2e-6 < p[0] - slope < 0.2e-6 + width  # where the response is another one
        return p[0] * x - data + np.where(x < 1.2, float(window), 0.0)

    found = fit(residuals, {"slope": 0.7}, {"slope": (0.01, 1.0)})
    low, high = found.intervals["slope"]
    assert found.values["slope"] == pytest.approx(slope, abs=1e-6)
    assert (low, high) == pytest.approx((slope - half, slope + half), abs=0.1 * half)
