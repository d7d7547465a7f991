"""The absorber on its oscillator once more: q1 the oscillator, q2 the absorber, friction and two walls between them."""

from orbits import DryFriction, Machine, Wall
from orbits.symbols import cos, sin


def motion(state, phase, p, contact):
    q1, q2, v1, v2 = state
    base = p.mass_ratio * p.forcing * (sin(phase) + p.mass_ratio * p.damping * p.frequency * cos(phase))
    return v1, v2, base - p.mass_ratio * p.damping * v1 - q1 + p.mass_ratio * contact.floor, -contact.floor


def wall(letter, side):
    push = {"v1": lambda state, phase, p: -side * p.mass_ratio, "v2": side}
    return Wall(letter, lambda state, phase, p: 1 - side * (state.q1 - state.q2), push, "restitution")


floor = DryFriction("floor", lambda s, phase, p: s.v1 - s.v2, lambda s, phase, p: p.friction * p.gravity)
machine = Machine(
    name="coupled_page",
    states=("q1", "q2", "v1", "v2"),
    parameters={
        "forcing": 2.47, "frequency": 1.01, "damping": 1.0, "mass_ratio": 0.006, "restitution": 0.76, "friction": 0.5, "gravity": 0.211
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[wall("L", 1), wall("R", -1), floor],
    mirror={"L": "R"},
)  # fmt: skip
