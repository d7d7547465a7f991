"""A ball on a table that shakes: y'' = -g, table at A cos(Omega t)."""

from orbits import Machine, Wall
from orbits.symbols import cos

machine = Machine(
    name="bouncing_ball",
    states=("y", "v"),
    parameters={"amplitude": 0.2, "frequency": 1.0, "gravity": 0.1, "restitution": 0.8},
    phase_rate="frequency",
    motion=lambda state, phase, p, contact: (state.v, -p.gravity),
    contacts=[
        Wall(
            "B",
            gap=lambda state, phase, p: state.y - p.amplitude * cos(phase),
            push={"v": 1.0},
            restitution="restitution",
        )
    ],
)
