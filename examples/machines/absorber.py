"""The reduced absorber once more: a mass with dry friction in a cavity that moves as v = C sin(phase)."""

from orbits import DryFriction, Machine, Wall
from orbits.symbols import sin


def wall(letter, side):
    return Wall(
        letter, lambda state, phase, p: 1 - side * state.w, push={"s": -side}, restitution="restitution"
    )


machine = Machine(
    name="absorber_page",
    states=("w", "s"),
    parameters={
        "amplitude": 0.55, "restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006, "frequency": 1.0,
    },
    phase_rate="frequency",
    motion=lambda state, phase, p, contact: (
        state.s,
        -p.amplitude * p.frequency**2 * sin(phase) + contact.floor,
    ),
    contacts=[
        wall("L", 1),
        wall("R", -1),
        DryFriction(
            "floor",
            velocity=lambda state, phase, p: state.s,
            limit=lambda state, phase, p: (1 + p.mass_ratio) * p.friction * p.gravity,
        ),
    ],
    mirror={"L": "R"},
)  # fmt: skip
