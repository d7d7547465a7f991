"""Two Duffing oscillators in a row, the second of which hits the first."""

from orbits import Machine, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    x, y, v, w = state
    link = p.coupling * (y - x) + p.damping * (w - v)
    return v, w, p.forcing * cos(phase) - p.damping * v - x - p.cubic * x**3 + link, -link / p.mass


machine = Machine(
    name="impact_duffing",
    states=("x", "y", "v", "w"),
    parameters={
        "forcing": 0.3, "frequency": 0.9, "damping": 0.1, "cubic": 0.2, "coupling": 0.3,
        "mass": 0.5, "gap": 0.5, "restitution": 0.7,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Wall(
            "M",
            gap=lambda state, phase, p: p.gap + state.x - state.y,
            push={"v": 1.0, "w": lambda state, phase, p: -1 / p.mass},
            restitution="restitution",
        )
    ],
)  # fmt: skip
