"""A mass on a spring that is driven and hits a wall: x'' + 2 D x' + x = F cos(Omega t), x <= gap."""

from orbits import Machine, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    x, v = state
    return v, p.forcing * cos(phase) - 2 * p.damping * v - x


machine = Machine(
    name="impact_oscillator",
    states=("x", "v"),
    parameters={"forcing": 1.0, "frequency": 2.3, "damping": 0.01, "gap": 0.0, "restitution": 0.8},
    # units={"x": "mm", "v": "mm/s", "gap": "mm", "frequency": "Hz"},  # formulas then see metres and seconds (extra "units")
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Wall("R", gap=lambda state, phase, p: p.gap - state.x, push={"v": -1.0}, restitution="restitution")
    ],
)
