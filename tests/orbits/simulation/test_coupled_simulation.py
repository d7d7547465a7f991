"""The coupled machine's event-driven simulation: physics that must hold whatever the parameters."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from orbits import Coupled
from orbits.attractors import find_attractor
from orbits.simulation import simulate
from tests.machines import COUPLED


def numbers(low, high):
    return st.floats(low, high, allow_nan=False).map(lambda value: round(value, 6))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    forcing=st.one_of(st.just(0.0), numbers(0.0, 5.0)),
    frequency=numbers(0.3, 2.5),
    damping=st.one_of(st.just(0.0), numbers(0.0, 4.0)),
    mass_ratio=st.sampled_from([0.001, 0.006, 0.05, 0.4]),
    restitution=st.one_of(st.just(1.0), numbers(0.05, 1.0)),
    friction=st.one_of(st.just(0.0), numbers(0.0, 1.0)),
    gravity=numbers(0.01, 0.5),
    excitation=st.sampled_from(["exact", "truncated"]),
    start=st.tuples(numbers(-1.0, 1.0), numbers(-1.0, 1.0), numbers(-1.5, 1.5), numbers(-1.5, 1.5)),
)
def test_no_wall_is_passed_no_energy_lost(start, **parameters):
    """|w| <= 1, alternating signs at the walls, time runs forward, and the energy balances, over up to 2000 events."""
    # close to an undamped resonance the response cancels against the free oscillation, and digits with it
    resonant = min(
        abs(parameters["frequency"] - 1.0),
        abs(parameters["frequency"] ** 2 * (1 + parameters["mass_ratio"]) - 1),
    )
    assume(parameters["damping"] > 0.01 or resonant > 1e-3)
    machine = Coupled(**parameters)
    first = dict(zip(("w", "w_rate", "v", "v_rate"), start))
    run = simulate(machine, first, events=2000, periods=300)
    assert np.all(np.abs(run.rows[:, 2]) <= 1.0)
    assert np.all(np.diff(run.phases) >= 0.0)
    left, right = run.codes == 0, run.codes == 1
    assert np.all(run.rows[left, 2] == 1.0) and np.all(run.rows[left, 3] > 0.0)
    assert np.all(run.rows[right, 2] == -1.0) and np.all(run.rows[right, 3] < 0.0)
    assert abs(run.balance().error) < 1e-9


def test_flights_between_events_hold_no_event():
    """Fine sampling between the events of a chaotic run: no wall passed, and w' keeps its sign while sliding."""
    machine = COUPLED.changed(mass_ratio=0.3, forcing=3.0, gravity=0.29, restitution=0.95, frequency=0.98)
    run = simulate(machine, {"w": -0.2, "w_rate": 0.4, "v": 0.6}, events=400)
    states, lengths = run.states[:-1], run.lengths[:-1]
    share = np.linspace(0.001, 0.999, 301)
    for state, length in zip(states, lengths):
        out = np.empty((share.size, 4))
        run.machine.sample(np.tile(state, (share.size, 1)), run.params, share * length, out)
        assert np.all(np.abs(out[:, 0]) <= 1.0 + 1e-12)
        if state[3] != 0.0:
            assert np.all(state[3] * out[:, 1] > 0.0)


@pytest.mark.parametrize(("frequency", "word"), [(0.985, "LR"), (0.99, "LRtt"), (1.0, "LRtR")])
def test_attractors_become_orbits(frequency, word):
    found = find_attractor(COUPLED, {"q1": 1.0, "q2": 1.0}, frequency=frequency)
    assert found.kind == "periodic"
    orbit = COUPLED.orbit(word, frequency=frequency)
    assert found.orbit.word.canonical() == orbit.word.canonical()
    assert orbit.real and orbit.stable
    assert orbit.replay() < 1e-11
