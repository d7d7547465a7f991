"""Two bodies that rub and hit each other, and one of them a stop and the ground: simulation keeps Newton's and Coulomb's laws at every instant."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from orbits import DryFriction, Machine, Wall
from orbits.contacts.dry_friction import STUCK
from orbits.contacts.wall import HELD
from orbits.symbols import cos, sin

ROUNDOFF = 1e-8


def wall(letter, gap, **push):
    return Wall(letter, gap, push, "restitution")


MACHINE = Machine(
    name="bodies",
    states=("x1", "x2", "v1", "v2"),
    parameters={
        "shaking": 0.5, "frequency": 1.5, "stiffness": 1.0, "weight": 0.3, "mass": 2.0,
        "room": 0.3, "restitution": 0.6, "between": 0.3, "below": 0.2,
    },
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (
        s.v1, s.v2,
        p.shaking * sin(phase) - p.stiffness * s.x1 - contact.rub + contact.ground,
        (contact.rub - p.weight) / p.mass,
    ),
    contacts=[
        wall("D", lambda s, f, p: s.x2 - s.x1, v1=-1.0, v2=lambda s, f, p: 1 / p.mass),
        wall("U", lambda s, f, p: p.room - s.x2 + s.x1, v1=1.0, v2=lambda s, f, p: -1 / p.mass),
        wall("G", lambda s, f, p: p.room - s.x1, v1=-1.0),
        DryFriction("rub", velocity=lambda s, f, p: s.v2 - s.v1, limit="between"),
        DryFriction("ground", velocity=lambda s, f, p: s.v1, limit="below", letters=("t2", "s2", "u2")),
    ],
)  # fmt: skip
DRAWN = {
    "shaking": st.floats(0.05, 1.5), "stiffness": st.sampled_from([0.0, 0.7, 2.5]), "weight": st.floats(0.0, 1.0),
    "mass": st.floats(0.1, 3.0), "room": st.floats(0.05, 1.0), "restitution": st.floats(0.1, 1.0),
    "between": st.floats(0.01, 0.8), "below": st.floats(0.01, 0.8),
}  # fmt: skip


def values(*numbers):
    return dict(zip(DRAWN, numbers))


@settings(max_examples=12, deadline=None)
@given(st.fixed_dictionaries(DRAWN), st.floats(0.0, 1.0), st.floats(0.0, 6.28))
# a hold that an impact elsewhere ends; a body that is pushed while another one rests; three contacts at one instant; bodies that begin together at rest
@example(values(1.2251, 0.7261, 0.0, 2.041, 0.3112, 0.6917, 0.4542, 0.01), 0.0, 0.0)
@example(values(0.3346, 0.0, 0.0, 2.0465, 0.9874, 0.5649, 0.01, 0.3013), 0.0, 0.0)
@example(values(0.7885, 0.0, 0.2652, 2.5972, 0.0723, 0.3144, 0.6326, 0.4979), 0.3218, 3.0988)
@example(values(0.3729, 1.8175, 0.8604, 1.9601, 0.9912, 0.7299, 0.5888, 0.1733), 0.0, 0.0)
def test_laws(numbers, place, phase) -> None:
    room = numbers["room"]
    run = MACHINE.simulate({"x2": place * room, "phase": phase}, periods=15, frequency=1.5, **numbers)
    clocks = np.linspace(run.clocks[0], run.finish, 1500)
    x1, x2, v1, v2 = (states := run.sample(clocks)).T
    small = ROUNDOFF * (1.0 + np.abs(states).max())
    piece = np.searchsorted(run.clocks, clocks, side="right") - 1
    modes = np.array(run.modes)[piece]
    inside = clocks - run.clocks[piece] > 1e-4  # what begins at rest has not yet left its roundoff before
    for gap, mode in zip((x2 - x1, room - x2 + x1, room - x1), modes.T):
        assert gap.min() > -small
        assert np.all(np.abs(gap[mode == HELD]) < 10.0 * small)
    for velocity, mode in zip((v2 - v1, v1), modes.T[3:]):
        assert np.all(np.abs(velocity[mode == STUCK]) < small)
        for way in (1, -1):
            assert np.all(way * velocity[(mode == way) & inside] > -small)


PRESSED = Machine(
    name="pressed",
    states=("x", "v"),
    parameters={"shaken": 0.0, "shaking": 0.0, "frequency": 1.5, "press": 0.1, "rub": 0.02, "room": 0.2, "restitution": 0.75},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (s.v, p.shaking * sin(phase) - p.press + contact.floor),
    contacts=[
        wall("D", lambda s, phase, p: s.x - p.shaken * cos(phase), v=1.0),
        wall("U", lambda s, phase, p: p.room - s.x, v=-1.0),
        DryFriction("floor", velocity=lambda s, phase, p: s.v, limit="rub"),
    ],
)  # fmt: skip


@settings(max_examples=8, deadline=None)
@given(rub=st.floats(0.01, 0.09), part=st.floats(0.1, 0.95), restitution=st.floats(0.2, 0.9))
def test_what_is_pressed_to_a_wall_stays(rub, part, restitution):
    """Pushed away from the wall by part of what friction holds, and against it by more than friction holds."""
    run = PRESSED.simulate(
        {}, periods=10, shaken=0.0, shaking=0.1 + part * rub, rub=rub, restitution=restitution
    )
    assert np.abs(run.sample(np.linspace(0.1, run.finish, 200))).max() < 1e-9


def test_starts_of_a_machine_that_rests():
    """A motion from rest that reaches nothing tells nothing of where to start: starts lie all over the room."""
    starts = PRESSED.population("frequency", shaken=0.0, shaking=0.1125).starts(200, 0, 1.5)
    assert np.histogram(starts[:, 1], 4, (0.0, 0.2))[0].min() > 30


def test_a_wall_that_moves_turns_the_friction_of_the_body_it_holds():
    """Pressed by P > A + mu it follows A cos(t); its velocity -A sin(t) changes its sign at multiples of pi, and friction with it."""
    numbers = {"shaken": 0.8, "press": 2.0, "rub": 0.5, "room": 9.0, "frequency": 1.0, "restitution": 0.5}
    start = {"x": 0.8 * np.cos(0.5), "v": -0.8 * np.sin(0.5), "phase": 0.5}
    run = PRESSED.simulate(start, periods=4.0, **numbers)
    turns = [clock for letter, clock in zip(run.letters, run.clocks[1:]) if letter == "t"]
    np.testing.assert_allclose(turns, np.pi * np.arange(1, 9), atol=1e-9)
    assert set(run.letters) <= {"t", "D", "(D"}
    clocks = np.linspace(run.clocks[0], run.finish, 200)
    np.testing.assert_allclose(run.sample(clocks)[:, 0], 0.8 * np.cos(clocks), atol=1e-9)
