"""An oscillator with a soft stop: a second spring acts beyond a gap."""

from orbits import Machine, Switch
from orbits.symbols import cos


def motion(state, phase, p, contact):
    x, v = state
    pressed = (1 + contact.stop) / 2  # 1 beyond the gap, else 0
    return v, p.forcing * cos(phase) - 2 * p.damping * v - x - p.stiffness * (x - p.gap) * pressed


machine = Machine(
    name="elastic_stop",
    states=("x", "v"),
    parameters={"forcing": 0.5, "frequency": 0.5, "damping": 0.05, "stiffness": 20.0, "gap": 1.0},
    phase_rate="frequency",
    motion=motion,
    contacts=[Switch("stop", surface=lambda state, phase, p: state.x - p.gap)],
)
