"""The absorber on its oscillator once more: q1 the oscillator, q2 the absorber, friction between them."""

from orbits import DryFriction, Machine, Wall
from orbits.symbols import cos, sin


def motion(state, phase, p, contact):
    q1, q2, v1, v2 = state
    shaking = p.mass_ratio * p.forcing * (sin(phase) + p.mass_ratio * p.damping * p.frequency * cos(phase))
    pull = shaking - p.mass_ratio * p.damping * v1 - q1
    return v1, v2, pull + p.mass_ratio * contact.floor, -contact.floor


def wall(letter, side):
    push = {"v1": lambda state, phase, p: -side * p.mass_ratio, "v2": side}
    return Wall(
        letter, lambda state, phase, p: 1 - side * (state.q1 - state.q2), push, restitution="restitution"
    )


machine = Machine(
    name="coupled_page",
    states=("q1", "q2", "v1", "v2"),
    parameters={
        "forcing": 2.47,
        "frequency": 1.01,
        "damping": 1.0,
        "mass_ratio": 0.006,
        "restitution": 0.76,
        "friction": 0.5,
        "gravity": 0.211,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        wall("L", 1),
        wall("R", -1),
        DryFriction(
            "floor",
            lambda state, phase, p: state.v1 - state.v2,
            lambda state, phase, p: p.friction * p.gravity,
        ),
    ],
    mirror={"L": "R"},
)
