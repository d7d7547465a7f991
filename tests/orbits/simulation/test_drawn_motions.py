"""Drawn motions of every machine, and motions that are hard to follow: each is one, and the native core follows it as its reference in plain Python does."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from contvines.core.library import native
from orbits import Absorber, Cavity, Coupled
from orbits.flows.native.simulator import collect, first_state
from orbits.machines.names import NAMES, model_class
from orbits.machines.native_stepper import stepper
from orbits.machines.reference.machine import reference
from orbits.machines.stepping import HOLD, MODE, PSI, RATE, REST, TIME_REACHED, TURNS, V
from orbits.simulation import simulate
from tests.machines import ABSORBER, COUPLED

needs_native = pytest.mark.skipif(not native(), reason="the native core is not loaded")

NUMBERS = {
    "amplitude": st.one_of(st.floats(0.01, 20.0), st.floats(1e-4, 0.3)),
    "forcing": st.one_of(st.just(0.0), st.floats(0.1, 5.0)),
    "frequency": st.floats(0.3, 3.0),
    "damping": st.one_of(st.just(0.0), st.floats(0.05, 4.0)),
    "mass": st.one_of(st.sampled_from([0.001, 0.006]), st.floats(0.001, 0.5)),
    "restitution": st.one_of(st.floats(0.05, 1.0), st.just(1.0)),
    "friction": st.one_of(st.floats(0.01, 1.0), st.just(0.0), st.floats(1e-6, 1e-3)),
    "gravity": st.floats(0.01, 2.0),
    "excitation": st.floats(0.0, 1.0),
    "slope": st.one_of(st.just(0.0), st.floats(-0.6, 0.6)),
    "distance": st.floats(0.3, 2.0),
}
PHASES = st.one_of(st.floats(0.0, 6.28), st.sampled_from([0.0, np.pi / 2, np.pi, 3 * np.pi / 2, 40.0]))
PLACES = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([1.0, -1.0, 0.0, 1.0 - 1e-12]))
SPEEDS = st.one_of(
    st.floats(-5.0, 5.0).filter(lambda rate: abs(rate) > 1e-6),
    st.sampled_from([0.0, 1e-9, -1e-9, 1e-6, -1e-4, 1e-14]),
)


@st.composite
def motions(draw):
    """A machine, a start, and the number that is not the machine's own."""
    kind = model_class(draw(st.sampled_from(NAMES)))
    given_ = {entry.name: draw(NUMBERS[entry.name.split("_")[0]]) for entry in kind.table}
    if given_.get("damping") == 0.0:
        # close to an undamped resonance the response cancels against the free oscillation, and digits with it
        stuck = 1.0 + given_["mass_ratio"]
        assume(min(abs(mass * given_["frequency"] ** 2 - 1.0) for mass in (1.0, stuck)) > 2e-3)
    machine = kind(**{name: given_.pop(name) for name in kind.field_names() if name in given_})
    left, right = machine.walls(machine.vector(given_))
    place = draw(PLACES)
    start = {"phase": draw(PHASES), "w": place * (left if place > 0.0 else -right), "w_rate": draw(SPEEDS)}
    if machine.name == "coupled":
        start |= {"v": draw(st.floats(-2.0, 2.0)), "v_rate": draw(st.floats(-2.0, 2.0))}
    return machine, start, given_


HELD = 1.006 * 0.5 * 0.211  # amplitude up to which friction holds the absorber
SMOOTH = Absorber(restitution=1.0, friction=0.0, gravity=0.2)
HARD = [
    (Absorber(restitution=0.3, friction=0.2, gravity=0.2), {"w_rate": 1.0}, 8.0),  # impacts pile up
    (ABSORBER, {"w": 0.3}, HELD),  # held by friction for ever, barely
    (ABSORBER, {"w": 0.3}, HELD * (1 + 1e-9)),  # ... and barely not
    (ABSORBER, {"phase": 4.2, "w": 1.0, "w_rate": -1e-9}, 0.55),  # a flight of 1e-9
    (SMOOTH, {}, 1.0),  # at rest at the very instant at which nothing pushes
    (SMOOTH, {"w": -1.0}, 1.0),  # ... and at the wall against which it is pushed next
    (SMOOTH.changed(restitution=0.3), {"phase": np.pi, "w": -1.0}, 0.2),
    (SMOOTH.changed(restitution=0.3), {"phase": np.pi}, 0.2),
    (Cavity(restitution=0.5, friction=0.0, gravity=0.1, slope=6e-267), {"phase": np.pi}, 0.2),  # ... pushed by less than rounding
    (SMOOTH, {"w_rate": 0.5}, 0.0),  # free drift
    (Cavity(restitution=0.6, friction=0.1, gravity=2.0, slope=0.6), {"w": 0.2}, 0.5),  # slides down
    (Coupled(restitution=0.3, friction=0.2, gravity=0.2, mass_ratio=0.3, damping=0.3, forcing=3.0, frequency=0.9), {"w": 1.0, "w_rate": -1e-8, "v": 2.0}, None),  # impacts pile up
    (COUPLED.changed(friction=0.0, excitation=0.0), {}, None),  # at rest when nothing pushes
    (COUPLED.changed(forcing=0.1, friction=1.0), {"w": 0.3, "v": 0.1}, None),  # sticks for ever
    (COUPLED.changed(frequency=0.985, slope=0.2), {"v_rate": 1.0}, None),
]  # fmt: skip
HARD = [(*case, {} if value is None else {"amplitude": value}) for *case, value in HARD]


def hard(test):
    """A property that hard motions have as well."""
    for case in HARD:
        test = example(case)(test)
    return test


FOLLOWS = {-1: "Rts", 1: "Lts", 0: "u"}
MODES = {"L": -1, "R": 1, "s": 0, "H": 0}


@settings(max_examples=350, deadline=None)
@given(motion=motions())
@hard
def test_every_run_is_a_motion(motion):
    """Walls, time, energy; events that can follow one another; every segment, in closed form, ends at its event and holds none in between."""
    machine, start, value = motion
    run = simulate(machine, start, periods=25, events=3000, **value)
    left, right = machine.walls(run.params)
    w, slides = run.rows[:, 2], not machine.frictionless(run.params)
    assert np.all((right <= w) & (w <= left)) and np.all(run.lengths >= 0.0)
    assert np.all(w[run.codes == 0] == left) and np.all(w[run.codes == 1] == right)
    assert run.balance().error < (1e-9 if machine.name == "coupled" else 1e-11)
    mode = int(run.start[MODE])
    for letter, after in zip(run.letters, map(int, run.modes)):
        assert letter == "H" or not slides or letter in FOLLOWS[mode]
        assert after == MODES.get(letter, after)
        mode = after
    flights = np.flatnonzero(run.codes != HOLD)  # to others belong impacts that pile up
    share = np.append(np.linspace(0.001, 0.999, 30), 1.0)
    ahead = run.lengths[flights, None] * share
    seen = run.flown(np.repeat(flights, len(share)), ahead.ravel()).reshape(*ahead.shape, 4)
    scale = 1e-12 * (1.0 + np.abs(run.states[:, [RATE, *range(V, run.states.shape[1])]]).max())
    assert np.abs(seen[:, -1, :2] - run.rows[flights, 2:4]).max(initial=0.0) < scale
    inside = seen[:, :-1, 0]
    assert right - scale <= inside.min(initial=0.0) and inside.max(initial=0.0) <= left + scale
    along = run.states[flights, MODE, None] * seen[:, :-1, 1]
    assert not slides or along.min(initial=0.0) > -scale


def both(motion, periods, events):
    """Codes, modes, rows and status, the state of the start and that of the end: by the native core and by the reference."""
    machine, start, value = motion
    params, found = machine.vector(value), []
    for engine in (stepper(machine.name), reference(machine.name)):
        now = first_state(machine, engine, params, start)
        launched = now.copy()
        found.append((*collect(engine, now, params, now[TURNS] + periods, events), launched, now))
    return found


def close(one, other, growth, turns=TURNS):
    """Equal but for rounding, which impacts and slips enlarge; a phase of 0 is that of 2 pi a turn before."""
    one, other = one.copy(), other.copy()
    for states in (one, other):
        states[..., PSI] += 2.0 * np.pi * states[..., turns]
        states[..., turns] = 0.0
    return np.abs(one - other).max(initial=0.0) <= 1e-12 * (1.0 + np.abs(other).max(initial=0.0)) * growth


@needs_native
@pytest.mark.parametrize("motion", HARD)
def test_both_cores_follow_hard_motions(motion):
    (codes, modes, rows, status, first, _), other = both(motion, 12.0, 60)
    assert status == other[3]
    assert np.array_equal(first[MODE:], other[4][MODE:])
    assert np.array_equal(codes[:24], other[0][:24]) and np.array_equal(modes[:24], other[1][:24])
    assert close(rows[:24], other[2][:24], 1e5, 1)


@needs_native
@settings(max_examples=300, deadline=None)
@given(motion=motions())
def test_both_cores_follow_drawn_motions(motion):
    (codes, modes, rows, status, first, end), other = both(motion, 4.0, 6)
    assert close(first, other[4], 1.0)
    if not np.array_equal(codes, other[0]):
        assert near_a_border(rows, other[2], codes, other[0])
        return
    assert np.array_equal(modes, other[1]) and status == other[3]
    growth = 1e4 / max(np.abs(rows[codes < 2, 3]).min(initial=1.0), 1e-8)
    assert close(rows, other[2], growth, 1)
    if status in (TIME_REACHED, REST):
        assert close(end, other[5], growth)


def near_a_border(rows, others, codes, other_codes):
    """Whether the first difference of two motions is an event that hardly happens: a slow impact, or one that rounding puts off."""
    n = min(len(codes), len(other_codes))
    place = int(np.argmax([*(codes[:n] != other_codes[:n]), True]))
    speeds = [abs(r[place, 3]) for r in (rows, others) if place < len(r)]
    before = rows[max(place - 1, 0) : place + 1]
    return min(speeds, default=0.0) < 1e-6 or np.ptp(before[:, 0] + 2 * np.pi * before[:, 1]) < 1e-6


def test_a_run_goes_on_where_it_ended():
    whole, first = (simulate(ABSORBER, {"w_rate": 1.0}, events=n, amplitude=1.1) for n in (40, 15))
    rest = simulate(ABSORBER, first.end, events=25, amplitude=1.1)
    assert first.letters + rest.letters == whole.letters
    assert np.array_equal(np.concatenate([first.rows, rest.rows]), whole.rows)


def test_a_long_run_is_followed_in_slices():
    """Free drift of an undamped absorber hits a wall every 2e4 time units; 60,000 periods are three slices."""
    run = simulate(SMOOTH, {"w_rate": 1e-4}, periods=60_000, amplitude=0.0)
    assert len(run) == int((60_000 * 2 * np.pi * 1e-4 - 1.0) // 2.0) + 1
    np.testing.assert_allclose(run.phases, 1e4 * (1.0 + 2.0 * np.arange(len(run))), rtol=1e-12)
