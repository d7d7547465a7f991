"""Calibration on data made by another simulator (scipy's integrator with events), with noise."""

import numpy as np
import pytest

from orbits import Coupled, Machine, Wall
from orbits.design.calibration import fit, from_impacts, from_sweep
from orbits.machines.parameters import ParameterError

TRUE = {"restitution": 0.63, "friction": 0.12}
REST = {"gravity": 0.25, "mass_ratio": 0.02, "damping": 1.5, "forcing": 6.0, "frequency": 1.0}


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


def test_estimates_of_a_declared_machine_stay_where_its_parameters_can_be():
    """A ball dropped from 1 under gravity 1 with e = 0.8 hits the floor sqrt 8 e^n apart; five times the guess 0.5 is no restitution."""
    ball = Machine(
        name="ball", states=("y", "v"), parameters={"e": 0.5}, motion=lambda s, phase, p, c: (s.v, -1.0),
        contacts=[Wall("B", lambda s, phase, p: s.y, {"v": 1.0}, "e")],
    )  # fmt: skip
    times = np.cumsum(np.sqrt(2.0) * np.array([1.0, *(2.0 * 0.8 ** np.arange(1, 8))]))
    found = from_impacts(ball, times, {"e": 0.5}, start={"y": 1.0})
    assert found.values["e"] == pytest.approx(0.8, abs=1e-6)
    with pytest.raises(ParameterError, match="e = 0 is no guess"):
        from_impacts(ball, times, {"e": 0.0}, start={"y": 1.0})
