"""Two impact absorbers with unlike clearances on one oscillator q: w1 and w2 ride in its two cavities."""

from orbits import Machine, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    q, w1, w2, v, s1, s2 = state
    return v, s1, s2, p.forcing * cos(phase) - 2 * p.damping * v - q, 0, 0


def wall(letter, absorber, clearance, side):
    def gap(state, phase, p):
        return getattr(p, clearance) - side * (getattr(state, f"w{absorber}") - state.q)

    push = {f"s{absorber}": -side, "v": lambda state, phase, p: side * p.mass}
    return Wall(letter, gap, push, "restitution")


machine = Machine(
    name="two_absorbers",
    states=("q", "w1", "w2", "v", "s1", "s2"),
    parameters={
        "forcing": 0.02, "frequency": 1.0, "damping": 0.01, "mass": 0.02, "restitution": 0.7, "near": 0.3, "far": 0.4
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[wall("A", 1, "near", 1), wall("B", 1, "near", -1), wall("C", 2, "far", 1), wall("D", 2, "far", -1)],
    mirror={"A": "B", "C": "D"},
)  # fmt: skip
