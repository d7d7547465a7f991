"""The native core's positions and shapes of segments against their references in numpy."""

import numpy as np
import pytest

from contvines.core.library import native
from orbits import Coupled
from orbits.machines.native_stepper import stepper
from orbits.machines.reference.machine import reference
from orbits.simulation.runs import simulate

pytestmark = pytest.mark.skipif(not native(), reason="the native core is not loaded")


def test_shapes_of_segments():
    """Largest displacements against a fine grid, integrals against the trapezoidal rule on it, and both cores against each other."""
    machine = Coupled(
        restitution=0.6, friction=0.4, gravity=0.3, mass_ratio=0.2, damping=0.5, forcing=2.0, frequency=0.9
    )
    run = simulate(machine, {"w_rate": 0.7, "v": 0.4}, events=12)
    states, lengths = run.states[:-1][:12], run.lengths[:12]
    found, wanted = np.empty((2, len(states), 4))
    stepper("coupled").shapes(states, run.params, lengths, found)
    reference("coupled").shapes(states, run.params, lengths, wanted)
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    for state, length, row in zip(states, lengths, found):
        ahead = np.linspace(0.0, length, 20001)
        motion = np.empty((len(ahead), 4))
        stepper("coupled").sample(np.tile(state, (len(ahead), 1)), run.params, ahead, motion)
        q1 = (motion[:, 2] + 0.2 * motion[:, 0]) / 1.2
        psi = state[0] + ahead
        integrals = [
            np.trapezoid(y, ahead)
            for y in (motion[:, 2] * np.sin(psi), motion[:, 2] * np.cos(psi), q1 * np.sin(psi))
        ]
        np.testing.assert_allclose(row, [np.abs(q1).max(), *integrals], atol=1e-7)
