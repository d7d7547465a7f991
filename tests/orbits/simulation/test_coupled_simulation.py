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


def test_long_runs_keep_the_energy_balance():
    run = simulate(COUPLED.changed(frequency=1.0), {"q1": 1.0}, events=14000)
    assert run.impacts > 10_000
    assert abs(run.balance().error) < 1e-11


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


def test_free_decay_loses_energy_and_comes_to_rest():
    """Without forcing: envelope of the linear oscillator as a bound, and rest in the end."""
    machine = COUPLED.changed(forcing=0.0)
    run = simulate(machine, {"q1": 1.2, "q2": 0.4}, periods=400)
    states = np.vstack([run.states, run.end])
    out = np.empty(len(states))
    run.machine.energies(states, run.params, out)
    assert np.all(np.diff(out) <= 1e-15)
    assert run.balance().excitation == 0.0
    # the damper alone would leave exp(-eps lambda tau) of the energy
    assert out[-1] < out[0] * np.exp(-0.006 * 2.0 * np.pi * 400)
    assert "at rest" in run.ended and run.letters[-1] == "s"


def test_complete_chatter_is_recognised():
    """A heavy absorber on a hard shaken cavity with soft walls: impacts pile up, the absorber rests on the wall, is released."""
    machine = COUPLED.changed(
        mass_ratio=0.3, forcing=3.125, frequency=0.986, damping=0.0, restitution=0.361, gravity=0.405
    )
    run = simulate(machine, {"w": 0.3, "w_rate": 0.2, "v": -0.4, "v_rate": 0.5}, events=600)
    holds = np.flatnonzero(run.codes[:-1] == 5)
    assert holds.size > 3
    assert np.all(np.abs(run.rows[holds, 2]) == 1.0)
    assert np.all(run.codes[holds + 1] == 4)  # released by a slip
    a = machine.friction_acceleration(run.params)
    eps, omega = machine.mass_ratio, machine.frequency
    for hold in holds:
        release = run.rows[hold + 1]
        side = release[2]
        q1, q1_rate = (release[5] + eps * side) / (1 + eps), release[6] / (1 + eps)
        push = eps * machine.forcing * np.sin(release[0]) - q1  # no damping
        assert push * side == pytest.approx(-a, abs=1e-12)  # friction holds until the pull inwards beats it
        assert -side * (eps * machine.forcing * omega * np.cos(release[0]) - q1_rate) > 0.0
    assert abs(run.balance().error) < 1e-9


def test_frictionless_flights_may_reverse():
    machine = COUPLED.changed(
        friction=0.0, mass_ratio=0.05, frequency=1.025, restitution=0.923, forcing=2.886
    )
    run = simulate(machine, {"w": 0.3, "v": 0.5}, events=300)
    assert set(run.letters) == {"L", "R"}
    assert "LL" in run.letters or "RR" in run.letters
    shy = simulate(machine.changed(friction=1e-12), {"w": 0.3, "v": 0.5}, events=30)
    impacts = [letter for letter in shy.letters if letter in "LR"]
    assert "".join(impacts) == run.letters[: len(impacts)]


def test_the_mirror_image_of_a_run_is_the_run_of_the_mirror_image():
    machine = COUPLED.changed(frequency=1.0)
    start = {"phase": 0.4, "w": 0.3, "w_rate": -0.2, "v": 0.7, "v_rate": 0.1}
    image = {key: (value + np.pi if key == "phase" else -value) for key, value in start.items()}
    one, two = simulate(machine, start, events=40), simulate(machine, image, events=40)
    assert two.letters == one.letters.translate(str.maketrans("LR", "RL"))
    np.testing.assert_allclose(two.phases - np.pi, one.phases, atol=1e-9)
    np.testing.assert_allclose(two.rows[:, 2:], -one.rows[:, 2:], atol=1e-9)


@pytest.mark.parametrize(("frequency", "word"), [(0.985, "LR"), (0.99, "LRtt"), (1.0, "LRtR")])
def test_attractors_become_orbits(frequency, word):
    found = find_attractor(COUPLED, {"q1": 1.0, "q2": 1.0}, frequency=frequency)
    assert found.kind == "periodic"
    orbit = COUPLED.orbit(word, frequency=frequency)
    assert found.orbit.word.canonical() == orbit.word.canonical()
    assert orbit.real and orbit.stable
    assert orbit.replay() < 1e-11
