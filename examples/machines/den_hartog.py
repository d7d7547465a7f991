"""Den Hartog's oscillator: x'' + x = F cos(Omega t) + dry friction."""

from orbits import DryFriction, Machine
from orbits.symbols import cos

machine = Machine(
    name="den_hartog",
    states=("x", "v"),
    parameters={"forcing": 1.0, "frequency": 0.8, "friction": 0.3},
    phase_rate="frequency",
    motion=lambda state, phase, p, contact: (state.v, p.forcing * cos(phase) - state.x + contact.floor),
    contacts=[DryFriction("floor", velocity=lambda state, phase, p: state.v, limit="friction")],
    mirror={},
)
