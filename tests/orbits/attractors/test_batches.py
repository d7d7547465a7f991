"""Many motions at once: each ends as the same motion run alone does."""

import numpy as np

from orbits.flows import simulator_of
from orbits.flows.native import batches
from orbits.flows.protocol import Outcome
from tests.machines import ABSORBER


def settled(amplitude, workers=1):
    """Seven motions from starts at phase 0."""
    starts = np.column_stack([np.zeros(7), np.linspace(-0.9, 0.9, 7), np.linspace(1.0, -1.0, 7)])
    simulator = simulator_of(ABSORBER, ABSORBER.vector({"amplitude": amplitude}))
    return simulator.settle_all(starts, 4, workers)


def test_motions_recur_as_the_simulator_says():
    found = settled(0.55)
    assert np.all(found.outcomes == Outcome.SETTLED)
    for state, periods in zip(found.states, found.periods):
        end = ABSORBER.simulate(state.copy(), periods=float(periods), amplitude=0.55).end
        np.testing.assert_allclose(end[[1, 2, 3]], state[[1, 2, 3]], atol=1e-7)


def test_shaking_that_friction_holds_ends_at_rest():
    """Below (1 + eps) mu g of acceleration nothing ever slips again: an amplitude of 0.1 is less than 0.106."""
    assert np.all(settled(0.1).outcomes == Outcome.AT_REST)


def test_the_number_of_threads_changes_nothing(monkeypatch):
    monkeypatch.setattr(batches, "BLOCK", 2)
    assert all(np.array_equal(one, two) for one, two in zip(settled(0.8), settled(0.8, workers=2)))
