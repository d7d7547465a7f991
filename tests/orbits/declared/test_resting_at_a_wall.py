"""A body pressed against a wall by more than shakes it never leaves it, whatever friction does (Newton's laws)."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import DryFriction, Machine, Wall
from orbits.symbols import sin


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
    assert np.abs(run.sample(np.linspace(0.1, run.end, 200))).max() < 1e-9


def test_starts_of_a_machine_that_rests() -> None:
    """A motion from rest that reaches nothing tells nothing of where to start: starts lie all over the room."""
    starts = MACHINE.population("frequency").starts(200, 0, 1.5)
    assert np.histogram(starts[:, 1], 4, (0.0, 0.2))[0].min() > 30
