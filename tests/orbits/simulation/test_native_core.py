"""The native simulator against its reference in plain Python, machine by machine: drawn motions, and motions that are hard to follow."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contvines.core.library import native
from orbits.flows.native.simulator import collect
from orbits.machines.names import model_class
from orbits.machines.native_stepper import stepper
from orbits.machines.reference.machine import reference
from orbits.machines.stepping import MODE, PSI, RATE, REST, TIME_REACHED, TURNS, V_RATE, V, W

pytestmark = pytest.mark.skipif(not native(), reason="the native core is not loaded")
NAMES = ("absorber", "cavity", "coupled")

positive = st.floats(0.02, 3.0)
fraction = st.one_of(st.floats(0.05, 1.0), st.just(1.0))
friction = st.one_of(st.floats(0.0, 1.0), st.just(0.0), st.floats(1e-6, 1e-3))
PARAMETERS = {
    "absorber": {"amplitude": positive, "restitution": fraction, "friction": friction, "gravity": st.floats(0.0, 2.0), "mass_ratio": st.floats(0.0, 0.5), "frequency": st.floats(0.3, 3.0)},
    "cavity": {
        "amplitude": positive, "restitution_left": fraction, "restitution_right": fraction, "friction_left": friction, "friction_right": friction,
        "gravity": st.floats(0.01, 2.0), "mass_ratio": st.floats(0.0, 0.5), "frequency": st.floats(0.3, 3.0), "slope": st.floats(-0.6, 0.6),
        "distance_left": st.floats(0.3, 2.0), "distance_right": st.floats(0.3, 2.0),
    },
    "coupled": {
        "forcing": st.floats(0.1, 5.0), "frequency": st.floats(0.5, 1.6), "damping": st.floats(0.05, 1.5), "mass_ratio": st.floats(0.005, 0.4),
        "restitution": fraction, "friction": friction, "gravity": st.floats(0.0, 1.0), "excitation": st.floats(0.0, 1.0),
        "slope": st.one_of(st.just(0.0), st.floats(-0.6, 0.6)),
    },
}  # fmt: skip
SPEEDS = st.one_of(st.floats(-3.0, 3.0), st.sampled_from([0.0, 1e-9, -1e-9, 1e-6, -1e-4, 1e-14]))
PLACES = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([1.0, -1.0, 0.0, 1.0 - 1e-12]))
PHASES = st.one_of(st.floats(0.0, 6.28), st.sampled_from([0.0, np.pi / 2, np.pi, 3 * np.pi / 2, 40.0]))


@st.composite
def motions(draw):
    """A machine's name, its parameters in order, and a start."""
    name = draw(st.sampled_from(NAMES))
    names = [entry.name for entry in model_class(name).table]
    params = np.array([draw(PARAMETERS[name][key]) for key in names])
    state = np.zeros(8 if name == "coupled" else 6)
    left, right = (float(wall) for wall in model_class(name).walls(params))
    place = draw(PLACES)
    state[PSI], state[W], state[RATE] = draw(PHASES), place * (left if place > 0 else -right), draw(SPEEDS)
    if name == "coupled":
        state[V], state[V_RATE] = draw(st.floats(-2.0, 2.0)), draw(st.floats(-2.0, 2.0))
    return name, params, state


def both(name, params, state, periods, events):
    found = []
    for engine in (stepper(name), reference(name)):
        now = state.copy()
        engine.launch(now, params)
        launched = now.copy()
        found.append((*collect(engine, now, params, now[TURNS] + periods, events), launched, now))
    return found


def close(one, other, growth):
    """Equal but for rounding, which impacts and slips enlarge."""
    return np.abs(one - other).max(initial=0.0) <= 1e-12 * (1.0 + np.abs(other).max(initial=0.0)) * growth


def through(states, turns=TURNS):
    """States or rows with phases counted through: a phase of 0 is that of 2 pi a turn before."""
    states = states.copy()
    states[..., PSI] += 2.0 * np.pi * states[..., turns]
    states[..., turns] = 0.0
    return states


def absorber(amplitude, restitution=0.76, friction=0.5, gravity=0.211):
    return np.array([amplitude, restitution, friction, gravity, 0.006, 1.0])


def start(psi, w, rate, v=None, v_rate=0.0):
    return np.array([psi, w, rate, 0.0, 0.0, 0.0, *([] if v is None else [v, v_rate])])


HARD = [
    ("absorber", absorber(8.0, 0.3, 0.2, 0.2), start(0.0, 0.0, 1.0)),  # impacts pile up
    ("absorber", absorber(1.006 * 0.5 * 0.211), start(0.0, 0.3, 0.0)),  # held by friction for ever, barely
    ("absorber", absorber(1.006 * 0.5 * 0.211 * (1 + 1e-9)), start(0.0, 0.3, 0.0)),  # ... and barely not
    ("absorber", absorber(0.55), start(4.2, 1.0, -1e-9)),  # a flight of 1e-9
    ("absorber", absorber(1.0, 1.0, 0.0, 1.0), start(0.0, 0.0, 0.0)),  # at rest when nothing pushes

    ("absorber", absorber(0.0, 1.0, 0.0, 0.2), start(0.0, 0.0, 0.5)),  # free drift

    ("cavity", np.array([0.5, 0.7, 0.6, 0.1, 0.1, 2.0, 0.1, 1.0, 0.6, 1.0, 0.8]), start(0.3, 0.2, 0.0)),  # slides down

    ("coupled", np.array([3.0, 0.9, 0.3, 0.3, 0.3, 0.2, 0.2, 1.0, 0.0]), start(0.0, 1.0, -1e-8, 2.0)),  # impacts pile up
    ("coupled", np.array([0.0, 1.0, 0.0, 0.2, 0.5, 0.0, 0.0, 1.0, 0.0]), start(0.0, 0.3, 0.0, 0.0)),  # nothing moves
    ("coupled", np.array([0.1, 1.0, 0.9, 0.1, 0.5, 1.0, 1.0, 1.0, 0.0]), start(0.0, 0.3, 0.0, 0.1)),  # sticks for ever
    ("coupled", np.array([2.47, 0.985, 0.9, 0.006, 0.76, 0.5, 0.211, 1.0, 0.2]), start(0.0, 0.0, 0.0, 1.0)),
]  # fmt: skip


@pytest.mark.parametrize("name, params, state", HARD)
def test_hard_motions(name, params, state):
    (codes, modes, rows, status, first, end), other = both(name, params, state, 12.0, 60)
    assert status == other[3]
    assert np.array_equal(first[MODE:], other[4][MODE:])
    few = min(len(codes), 24)
    assert np.array_equal(codes[:few], other[0][:few]) and np.array_equal(modes[:few], other[1][:few])
    assert close(through(rows[:few], 1), through(other[2][:few], 1), 1e5)


@settings(max_examples=300, deadline=None)
@given(motion=motions())
def test_drawn_motions(motion):
    name, params, state = motion
    (codes, modes, rows, status, first, end), other = both(name, params, state, 4.0, 6)
    assert close(first, other[4], 1.0)
    if len(codes) != len(other[0]) or not np.array_equal(codes, other[0]):
        assert _near_a_border(rows, other[2], codes, other[0])
        return
    assert np.array_equal(modes, other[1]) and status == other[3]
    speed = np.abs(rows[codes < 2, 3]).min(initial=1.0)
    assert close(through(rows, 1), through(other[2], 1), 1e4 / max(speed, 1e-8))
    if status in (TIME_REACHED, REST):
        assert close(through(end), through(other[5]), 1e4 / max(speed, 1e-8))


def _near_a_border(rows, others, codes, other_codes):
    """Whether the first difference of two motions is an event that hardly happens: a slow impact, or one that rounding puts off."""
    n = min(len(codes), len(other_codes))
    place = (
        int(np.argmax(codes[:n] != other_codes[:n])) if not np.array_equal(codes[:n], other_codes[:n]) else n
    )
    speeds = [abs(r[place, 3]) for r in (rows, others) if place < len(r)]
    before = rows[max(place - 1, 0) : place + 1]
    return min(speeds, default=0.0) < 1e-6 or np.ptp(before[:, 0] + 2 * np.pi * before[:, 1]) < 1e-6


def test_a_long_run_is_followed_in_slices():
    """Free drift of an undamped absorber hits a wall every 4/0.5 time units; 60,000 periods are three slices."""
    engine, params = stepper("absorber"), absorber(0.0, 1.0, 0.0, 0.2)
    state = start(0.0, 0.0, 1e-4)
    engine.launch(state, params)
    codes, _, rows, status = collect(engine, state, params, 60_000.0, 1000)
    instants = rows[:, 0] + 2 * np.pi * rows[:, 1]
    assert status == TIME_REACHED
    assert len(codes) == int((60_000 * 2 * np.pi * 1e-4 - 1.0) // 2.0) + 1
    np.testing.assert_allclose(instants, 1e4 * (1.0 + 2.0 * np.arange(len(codes))), rtol=1e-12)
