"""Many motions at once: each ends as the same motion run alone does."""

import numpy as np

import orbits
from orbits.flows.native import batches
from orbits.flows.native.batches import AT_REST, SETTLED, settle_all
from orbits.population import Population
from orbits.simulation import simulate
from tests.machines import ABSORBER


def run(states, amplitude, **options):
    params = ABSORBER.vector({"amplitude": amplitude})
    settings = {"transients": (300.0,), "longest": 4, "tolerance": 1e-9, "workers": 1} | options
    return params, settle_all("absorber", states, params, **settings)


def starts(count):
    states = np.zeros((count, 6))
    states[:, 1] = np.linspace(-0.9, 0.9, count)
    states[:, 2] = np.linspace(1.0, -1.0, count)
    return states


def test_motions_recur_as_the_simulator_says():
    states = starts(6)
    params, found = run(states, 0.55)
    assert np.all(found["outcome"] == SETTLED)
    for state, periods, impacts in zip(states, found["periods"], found["impacts"]):
        trajectory = simulate(ABSORBER, state.copy(), periods=float(periods), amplitude=0.55)
        assert np.sum(trajectory.codes < 2) == impacts
        np.testing.assert_allclose(trajectory.end[[1, 2, 3]], state[[1, 2, 3]], atol=1e-7)


def test_shaking_that_friction_holds_ends_at_rest():
    """Below (1 + eps) mu g of acceleration nothing ever slips again: an amplitude of 0.1 is less than 0.106."""
    _, found = run(starts(4), 0.1)
    assert np.all(found["outcome"] == AT_REST)


def test_the_number_of_threads_changes_nothing(monkeypatch):
    monkeypatch.setattr(batches, "BLOCK", 2)
    one, two = starts(7), starts(7)
    first, second = run(one, 0.8)[1], run(two, 0.8, workers=2)[1]
    assert np.array_equal(one, two) and all(np.array_equal(first[name], second[name]) for name in first)


def test_chaotic_transients_of_ten_thousand_periods_are_followed_to_their_end():
    machine = orbits.Coupled(mass_ratio=0.0106, restitution=0.6535, friction=0.005, gravity=0.3)
    values = {"damping": 0.934, "frequency": 0.977}
    population = Population(machine, "forcing", values, workers=1)
    starts = population.starts(64, 0, 0.778)
    motions, index, _ = population.settle(starts, 0.778)
    late = dict(zip(population.names, starts[3]))
    assert machine.attractor(late, transient=0, forcing=0.778, **values).kind == "chaotic"
    later = machine.attractor(late, transient=100_000, forcing=0.778, **values)
    assert [motion.word for motion in motions] == [later.text] == ["tt"] and not index.any()
