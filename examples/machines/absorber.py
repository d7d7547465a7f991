"""The reduced absorber once more: a mass with dry friction in a cavity that moves as C sin(phase)."""

from orbits import DryFriction, Machine, Wall
from orbits.symbols import sin


def motion(state, phase, p, contact):
    w, s = state
    return s, -p.amplitude * p.frequency**2 * sin(phase) + contact.floor


def wall(letter, side):
    return Wall(letter, lambda state, phase, p: 1 - side * state.w, {"s": -side}, "restitution")


def limit(state, phase, p):
    return (1 + p.mass_ratio) * p.friction * p.gravity


machine = Machine(
    name="absorber_page",
    states=("w", "s"),
    parameters={"amplitude": 0.55, "restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006, "frequency": 1.0},
    phase_rate="frequency",
    motion=motion,
    contacts=[wall("L", 1), wall("R", -1), DryFriction("floor", lambda state, phase, p: state.s, limit)],
    mirror={"L": "R"},
)  # fmt: skip
