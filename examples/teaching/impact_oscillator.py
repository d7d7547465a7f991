"""A mass on a spring, shaken, with a rigid wall at a distance: x'' + 2 D x' + x = F cos(w t) for x < gap."""

from orbits import Machine, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    x, v = state
    return v, p.forcing * cos(phase) - 2 * p.damping * v - x


machine = Machine(
    name="impact_oscillator",
    states=("x", "v"),
    parameters={"forcing": 0.2, "frequency": 0.8, "damping": 0.05, "gap": 1.0, "restitution": 0.8},
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Wall("R", gap=lambda state, phase, p: p.gap - state.x, push={"v": -1.0}, restitution="restitution")
    ],
)
