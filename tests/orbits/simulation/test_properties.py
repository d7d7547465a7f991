"""Properties over fuzzed machines and starts: bounds, energy, order of events, mirror image, bounded work."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from orbits.machines.absorber import Absorber
from orbits.simulation import simulate

FOLLOWS = {-1: "Rts", 1: "Lts", 0: "u"}


def speeds():
    tiny = st.sampled_from([0.0, 1e-9, -1e-9, 1e-6, -1e-4])
    return st.one_of(st.floats(-5.0, 5.0).filter(lambda x: abs(x) > 1e-6), tiny)


machines = st.builds(
    Absorber,
    restitution=st.one_of(st.floats(0.05, 1.0), st.just(1.0)),
    friction=st.one_of(st.floats(0.01, 1.0), st.just(0.0), st.floats(1e-6, 1e-3)),
    gravity=st.floats(0.01, 2.0),
    mass_ratio=st.just(0.006),
    frequency=st.floats(0.3, 3.0),
)
starts = st.fixed_dictionaries(
    {
        "phase": st.one_of(st.floats(0.0, 6.28), st.sampled_from([0.0, np.pi / 2, np.pi, 3 * np.pi / 2])),
        "w": st.one_of(st.floats(-1.0, 1.0), st.sampled_from([1.0, -1.0, 0.0, 1.0 - 1e-12])),
        "w_rate": speeds(),
    }
)
amplitudes = st.one_of(st.floats(0.01, 20.0), st.floats(1e-4, 0.3))


@settings(max_examples=300, deadline=None)
@given(machine=machines, start=starts, amplitude=amplitudes)
@example(
    Absorber(restitution=0.3, friction=0.0, gravity=1.0), {"phase": np.pi, "w": -1.0, "w_rate": 0.0}, 0.2
)
@example(
    Absorber(restitution=1.0, friction=0.0, gravity=1.0), {"phase": 0.0, "w": 0.0, "w_rate": 0.0}, 1.0
)  # at rest at the very instant at which nothing pushes
@example(
    Absorber(restitution=1.0, friction=0.0, gravity=1.0), {"phase": 0.0, "w": -1.0, "w_rate": 0.0}, 1.0
)  # ... and at the wall against which it is pushed next
def test_every_run_is_a_motion(machine, start, amplitude):
    run = simulate(machine, start, periods=25, events=12000, amplitude=amplitude)
    assert np.all(np.abs(run.rows[:, 2]) <= 1.0)
    assert np.all(run.lengths >= 0.0)
    assert run.balance().error < 1e-11
    frictionless = machine.friction == 0.0
    mode = int(run.start[3])
    for letter, after in zip(run.letters, run.modes):
        if letter != "H" and not frictionless:
            assert letter in FOLLOWS[mode]
        mode = int(after)
        assert mode == {"L": -1, "R": 1, "s": 0, "H": 0}.get(letter, mode)
    ends = np.empty((len(run), 4))  # each segment, evaluated at its end, meets the event that ended it
    run.machine.sample(run.states[:-1], run.params, run.lengths[:-1], ends)
    scale = 1.0 + amplitude * (1.0 + machine.frequency) ** 2
    meets = run.codes != 5
    assert np.abs(ends[meets, 0] - run.rows[meets, 2]).max(initial=0.0) < 1e-12 * scale
    assert np.abs(ends[meets, 1] - run.rows[meets, 3]).max(initial=0.0) < 1e-12 * scale
    if len(run) < 12000:  # in between, evaluated in closed form: inside the walls, and never against the mode
        seen = run.sample(per_period=61)
        assert np.abs(seen.w).max() <= 1.0 + 1e-14
        begins = run.states[:, 0] + 2 * np.pi * run.states[:, 4]
        place = np.clip(np.searchsorted(begins, seen.phase, side="right") - 1, 0, None)
        if not frictionless:
            assert (run.states[place, 3] * seen.w_rate).min() > -1e-12


def test_a_run_goes_on_where_it_ended():
    machine = Absorber(restitution=0.7, friction=0.3, gravity=0.3)
    whole = simulate(machine, {"w_rate": 1.0}, events=40, amplitude=1.1)
    first = simulate(machine, {"w_rate": 1.0}, events=15, amplitude=1.1)
    rest = simulate(machine, first.end, events=25, amplitude=1.1)
    assert first.letters + rest.letters == whole.letters
    assert np.array_equal(np.concatenate([first.rows, rest.rows]), whole.rows)
