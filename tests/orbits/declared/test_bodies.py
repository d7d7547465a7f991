"""Two bodies that rub and hit each other, and one of them a stop and the ground: simulation keeps Newton's and Coulomb's laws at every instant."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from orbits import DryFriction, Machine, Wall
from orbits.contacts.dry_friction import STUCK
from orbits.contacts.wall import HELD
from orbits.symbols import sin

ROUNDOFF = 1e-8


def motion(state, phase, p, contact):
    first = p.shaking * sin(phase) - p.stiffness * state.x1 - contact.rub + contact.ground
    return state.v1, state.v2, first, (contact.rub - p.weight) / p.mass


MACHINE = Machine(
    name="bodies",
    states=("x1", "x2", "v1", "v2"),
    parameters={
        "shaking": 0.5, "frequency": 1.5, "stiffness": 1.0, "weight": 0.3, "mass": 2.0,
        "room": 0.3, "restitution": 0.6, "between": 0.3, "below": 0.2,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Wall("D", gap=lambda s, f, p: s.x2 - s.x1, push={"v1": -1.0, "v2": lambda s, f, p: 1 / p.mass}, restitution="restitution"),
        Wall("U", gap=lambda s, f, p: p.room - s.x2 + s.x1, push={"v1": 1.0, "v2": lambda s, f, p: -1 / p.mass}, restitution="restitution"),
        Wall("G", gap=lambda s, f, p: p.room - s.x1, push={"v1": -1.0}, restitution="restitution"),
        DryFriction("rub", velocity=lambda s, f, p: s.v2 - s.v1, limit="between"),
        DryFriction("ground", velocity=lambda s, f, p: s.v1, limit="below", letters=("t2", "s2", "u2")),
    ],
)  # fmt: skip


@settings(max_examples=12, deadline=None)
@given(
    shaking=st.floats(0.05, 1.5),
    stiffness=st.sampled_from([0.0, 0.7, 2.5]),
    weight=st.floats(0.0, 1.0),
    mass=st.floats(0.1, 3.0),
    room=st.floats(0.05, 1.0),
    restitution=st.floats(0.1, 1.0),
    between=st.floats(0.01, 0.8),
    below=st.floats(0.01, 0.8),
    place=st.floats(0.0, 1.0),
    phase=st.floats(0.0, 6.28),
)
# a hold that an impact elsewhere ends; a body that is pushed while another one rests; three contacts at one instant; bodies that begin together at rest
@example(1.2251, 0.7261, 0.0, 2.041, 0.3112, 0.6917, 0.4542, 0.01, 0.0, 0.0)
@example(0.3346, 0.0, 0.0, 2.0465, 0.9874, 0.5649, 0.01, 0.3013, 0.0, 0.0)
@example(0.7885, 0.0, 0.2652, 2.5972, 0.0723, 0.3144, 0.6326, 0.4979, 0.3218, 3.0988)
@example(0.3729, 1.8175, 0.8604, 1.9601, 0.9912, 0.7299, 0.5888, 0.1733, 0.0, 0.0)
def test_laws(shaking, stiffness, weight, mass, room, restitution, between, below, place, phase) -> None:
    run = MACHINE.simulate(
        {"x2": place * room, "phase": phase},
        periods=15,
        shaking=shaking,
        stiffness=stiffness,
        weight=weight,
        mass=mass,
        room=room,
        restitution=restitution,
        between=between,
        below=below,
        frequency=1.5,
    )
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
