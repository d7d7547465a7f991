"""Numbers of modulated motions: a periodic one has no band; a modulated one as a dense sampling of the simulation has it."""

import numpy as np
import pytest

from orbits import Coupled
from orbits.attractors import find_attractor
from orbits.attractors.modulation import STRONG, WEAK, modulation
from orbits.machines.catalogue import stepper
from orbits.simulation import simulate

MACHINE = Coupled(
    mass_ratio=0.01, restitution=0.7, friction=0.155, gravity=0.194, damping=2.0, excitation=1.0
)


def of(parameters, periods=64):
    found = find_attractor(MACHINE, observed=False, **parameters)
    params = MACHINE.vector(parameters)
    return found, modulation(MACHINE, stepper("coupled"), params, found.state, periods)


def test_a_periodic_motion_has_no_band():
    found, seen = of({"forcing": 10.0, "frequency": 0.9})
    assert found.recurrent
    top = found.found.root().measure("max_abs_q1")  # of the closed form
    assert (seen.low, seen.mean, seen.high) == pytest.approx((top, top, top), rel=2e-3)
    assert seen.silent == 0.0 and seen.kind == WEAK


def test_a_modulated_motion_is_that_of_a_dense_sampling():
    found, seen = of({"forcing": 10.0, "frequency": 1.0})
    assert not found.recurrent
    run = simulate(MACHINE, found.state, periods=64.0, events=None, forcing=10.0, frequency=1.0)
    sample = run.sample(per_period=1000)
    tops = [np.abs(part).max() for part in np.array_split(sample.cavity, 64)]
    assert seen.high == pytest.approx(max(tops), rel=5e-3) and seen.low == pytest.approx(min(tops), rel=5e-3)
    assert seen.mean == pytest.approx(np.mean(tops), rel=5e-3)
    assert seen.low < seen.mean < seen.high


def test_impacts_that_stop_and_begin_again_make_it_strong():
    from orbits.attractors.modulation import Modulation

    assert Modulation(1.0, 2.0, 3.0, 0.4).kind == STRONG
    assert Modulation(1.0, 2.0, 3.0, 1.0).kind == WEAK  # no impacts at all
