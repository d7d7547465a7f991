"""Two impact absorbers with unlike clearances on one oscillator: q is the oscillator, w1 and w2 ride in its two cavities."""

from orbits import Machine, Wall
from orbits.symbols import cos


def motion(state, phase, p, contact):
    q, w1, w2, v, s1, s2 = state  # w: position of an absorber, s: its speed
    return v, s1, s2, p.forcing * cos(phase) - 2 * p.damping * v - q, 0 * w1, 0 * w2


def stop(letter, place, clearance, side):
    def gap(state, phase, p):
        return getattr(p, clearance) - side * (getattr(state, f"w{place}") - state.q)

    return Wall(
        letter,
        gap,
        push={f"s{place}": -side, "v": lambda state, phase, p: side * p.mass},
        restitution="restitution",
    )


machine = Machine(
    name="two_absorbers",
    states=("q", "w1", "w2", "v", "s1", "s2"),
    parameters={
        "forcing": 0.02,
        "frequency": 1.0,
        "damping": 0.01,
        "mass": 0.02,
        "restitution": 0.7,
        "near": 0.3,
        "far": 0.4,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        stop("A", 1, "near", 1),
        stop("B", 1, "near", -1),
        stop("C", 2, "far", 1),
        stop("D", 2, "far", -1),
    ],
    mirror={"A": "B", "C": "D"},
)
