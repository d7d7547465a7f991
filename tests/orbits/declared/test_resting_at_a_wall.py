"""A body pressed against a wall by more than shakes it never leaves it, whatever friction does (Newton's laws)."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import DryFriction, Machine, Wall
from orbits.symbols import cos, sin


def motion(state, phase, p, contact):
    _, w = state
    return w, p.shaking * sin(phase) - p.pressed + contact.bearing


MACHINE = Machine(
    name="pressed",
    states=("q", "w"),
    parameters={
        "shaking": 0.1125,
        "frequency": 1.5,
        "pressed": 0.1,
        "rub": 0.02,
        "room": 0.2,
        "restitution": 0.75,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Wall("D", gap=lambda s, f, p: s.q, push={"w": 1.0}, restitution="restitution"),
        Wall("U", gap=lambda s, f, p: p.room - s.q, push={"w": -1.0}, restitution="restitution"),
        DryFriction("bearing", velocity=lambda s, f, p: s.w, limit="rub"),
    ],
)


@settings(max_examples=8, deadline=None)
@given(rub=st.floats(0.01, 0.09), part=st.floats(0.1, 0.95), restitution=st.floats(0.2, 0.9))
def test_it_stays(rub: float, part: float, restitution: float) -> None:
    """Pushed away from the wall by part of what friction holds, and against it by more than friction holds."""
    run = MACHINE.simulate(
        {"q": 0.0}, periods=10, shaking=0.1 + part * rub, rub=rub, restitution=restitution, frequency=1.5
    )
    assert np.abs(run.sample(np.linspace(0.1, run.finish, 200))).max() < 1e-9


def test_starts_of_a_machine_that_rests() -> None:
    """A motion from rest that reaches nothing tells nothing of where to start: starts lie all over the room."""
    starts = MACHINE.population("frequency").starts(200, 0, 1.5)
    assert np.histogram(starts[:, 1], 4, (0.0, 0.2))[0].min() > 30


def test_a_wall_that_moves_turns_the_friction_of_the_body_it_holds():
    """Pressed by P > A + mu it follows A cos(t); its velocity -A sin(t) changes its sign at multiples of pi, and friction with it."""
    machine = Machine(
        name="pressed",
        states=("x", "v"),
        parameters={"press": 2.0, "shaking": 0.8, "friction": 0.5, "frequency": 1.0},
        phase_rate="frequency",
        motion=lambda state, phase, p, contact: (state.v, contact.floor - p.press),
        contacts=[
            Wall("L", lambda state, phase, p: state.x - p.shaking * cos(phase), {"v": 1}, 0.5),
            DryFriction("floor", lambda state, phase, p: state.v, "friction"),
        ],
    )
    start = {"x": 0.8 * np.cos(0.5), "v": -0.8 * np.sin(0.5), "phase": 0.5}
    run = machine.simulate(start, periods=4.0)
    turns = [clock for letter, clock in zip(run.letters, run.clocks[1:]) if letter == "t"]
    np.testing.assert_allclose(turns, np.pi * np.arange(1, 1 + len(turns)), atol=1e-9)
    assert len(turns) == 8 and set(run.letters) <= {"t", "L", "(L"}
    clocks = np.linspace(run.clocks[0], run.finish, 200)
    np.testing.assert_allclose(run.sample(clocks)[:, 0], 0.8 * np.cos(clocks), atol=1e-9)
