"""A mass before a wall lined with rubber: beyond a gap a spring and a damper press back, and the lining lets go where their force would pull."""

from orbits import Machine, Switch
from orbits.symbols import cos


def rubber(state, p):
    """The force with which the lining presses back."""
    x, v = state
    return p.stiffness * (x - p.gap) + p.loss * v


def motion(state, phase, p, contact):
    x, v = state
    pressed = (
        (1 + contact.deep) * (1 + contact.holds) / 4
    )  # 1 where the mass is in the lining and the lining presses, else 0
    return v, p.forcing * cos(phase) - 2 * p.damping * v - x - rubber(state, p) * pressed


machine = Machine(
    name="rubber_wall",
    states=("x", "v"),
    parameters={
        "forcing": 0.5,
        "frequency": 0.8,
        "damping": 0.02,
        "stiffness": 30.0,
        "loss": 1.5,
        "gap": 0.5,
    },
    phase_rate="frequency",
    motion=motion,
    contacts=[
        Switch("deep", surface=lambda state, phase, p: state.x - p.gap),
        Switch("holds", surface=lambda state, phase, p: rubber(state, p)),
    ],
)
