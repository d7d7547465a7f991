"""Statistics of motions that do not recur: they must not depend on when the observation begins."""

from dataclasses import replace

import numpy as np
import pytest

from orbits import Coupled
from orbits.attractors import find_attractor, sweep
from orbits.attractors.attractor import lasting, observe
from orbits.machines.stepping import HOLD
from orbits.simulation import simulate
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow

# strongly modulated: the oscillator grows without impacts for tens of periods, then the absorber brakes it
MODULATED = Coupled(
    damping=0.8, mass_ratio=0.01, restitution=0.7, friction=0.3, gravity=0.25, frequency=1.0, forcing=0.9412
)


@pytest.fixture(scope="module")
def reference():
    """One plain run of 40,000 periods, sampled: largest |q1|, impacts per period."""
    run = simulate(MODULATED, periods=500)
    peak, impacts = 0.0, 0
    for _ in range(80):
        run = simulate(MODULATED, run.end, periods=500)
        peak = max(peak, float(np.abs(run.sample(per_period=40).cavity).max()))
        impacts += run.impacts
    return peak, impacts / 40_000


@pytest.mark.parametrize("transient", [200, 300, 600])
def test_a_modulated_response_is_seen_whole(reference, transient):
    (row,) = sweep(MODULATED, "forcing", [0.9412], transient=transient)
    assert (row.attractor, row.periods) == ("chaotic", 0)
    assert row.measures["max_abs_q1"] == pytest.approx(reference[0], rel=0.03)
    assert row.measures["impacts_per_period"] == pytest.approx(reference[1], rel=0.06)
    assert row.detail.impacts_per_period == row.measures["impacts_per_period"]
    assert row.detail.impact_speed == row.measures["impact_speed"]


def test_chaos_of_the_reduced_machine():
    """The fastest impact and the mean number of impacts agree between two starts and with a plain run."""
    machine = ABSORBER
    run = simulate(machine, {"w_rate": 1.0}, periods=300, amplitude=1.5)
    run = simulate(machine, run.end, periods=30_000, amplitude=1.5)
    fastest = np.abs(run.rows[run.codes < 2, 3]).max()
    for rate in (0.2, 1.0):
        found = find_attractor(machine, {"w_rate": rate}, amplitude=1.5)
        assert found.kind == "chaotic"
        assert found.impacts_per_period == pytest.approx(run.impacts / 30_000, rel=0.02)
        assert found.impact_speed == pytest.approx(fastest, rel=0.02)


def test_a_rare_contact_is_no_chatter_whenever_it_comes():
    """This motion rests on a wall once in some 150 periods: chaos from every start; often enough would be chatter."""
    machine = Coupled(
        damping=0.8,
        mass_ratio=0.01,
        restitution=0.3,
        friction=0.05,
        gravity=0.25,
        frequency=1.0,
        forcing=0.95,
    )
    for transient in (200, 230, 260, 300):
        (row,) = sweep(machine, "forcing", [0.95], transient=transient)
        run = simulate(machine, row.detail.state, periods=3000)
        assert 0 < np.count_nonzero(run.codes == HOLD) < 3000 / 32
        assert (row.attractor, row.periods) == ("chaotic", 0)
    seen = observe(row.detail)
    assert lasting(row.detail, replace(seen, contacts=int(seen.periods / 10))).kind == "chatter"
