"""The plain stepper takes the parameter vector of a machine with units, whose scales stand behind the machine's own numbers."""

import numpy as np

from orbits.flows.native.simulator import first_state
from orbits.machines.native_stepper import stepper as machine
from orbits.machines.physical import physical
from orbits.machines.reference.machine import reference

CASE = {
    "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
    "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
}  # fmt: skip


def test_units_change_no_motion():
    model = physical("coupled", CASE)
    params = model.vector({})
    plain = params[: len(model.base.parameter_names)]
    assert len(plain) < len(params)
    begin = first_state(
        model, machine(model.name), params, {"w": 0.3, "w_rate": 0.4, "v": 0.1, "v_rate": -0.2}
    )
    ends, stepper = [], reference("coupled")
    for vector in (params, plain):
        state, positions = begin.copy(), np.zeros((5, 4))
        stepper.launch(state, vector)
        stepper.sample(np.tile(state, (5, 1)), vector, np.linspace(0.0, 0.1, 5), positions)
        ends.append(np.append(state, positions))
    assert np.all(np.isfinite(ends)) and np.array_equal(*ends)
