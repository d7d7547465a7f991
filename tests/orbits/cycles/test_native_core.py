"""The native core's positions and shapes of segments against their references in numpy."""

import numpy as np
import pytest

from contvines.core.library import native
from orbits import Absorber, Coupled
from orbits.flows.native import driven_measures
from orbits.flows.native.sampling import positions_of, reference_positions
from orbits.machines.catalogue import reference_stepper, stepper
from orbits.machines.reference.machine import reference
from orbits.simulation.runs import simulate

pytestmark = pytest.mark.skipif(not native(), reason="the native core is not loaded")


@pytest.mark.parametrize("name", ["absorber", "coupled"])
@pytest.mark.parametrize("count", [7, 200])
def test_positions(name, count):
    """Of a cycle whose first event comes late in a period, and of one node out of order, as Newton's method may try it."""
    if name == "absorber":
        params = np.array([0.55, 0.76, 0.5, 0.211, 0.006, 1.0])
        nodes = np.array([[5.5, 0.8], [7.6, 0.3], [7.4, -0.2], [9.0, 1.1]])
    else:
        params = np.array([2.47, 0.985, 0.9, 0.006, 0.76, 0.5, 0.211, 1.0, 0.1])
        nodes = np.array(
            [[5.5, 0.8, 0.1, 0.4], [7.6, 0.3, 0.2, -0.3], [7.4, -0.2, 0.3, 0.6], [9.0, 1.1, -0.4, 0.2]]
        )
    codes, modes = np.array([0, 2, 3, 1], np.int8), np.array([-1, 1, 0, 1], np.int8)
    arguments = params, codes, modes, nodes, 4.0 * np.pi, count
    found, wanted = (
        positions_of(stepper(name), *arguments),
        reference_positions(reference_stepper(name), *arguments),
    )
    np.testing.assert_allclose(found, wanted, atol=1e-13 * np.abs(wanted).max())


def test_shapes_of_segments():
    """Largest displacements against a fine grid, integrals against the trapezoidal rule on it, and both cores against each other."""
    machine = Coupled(
        restitution=0.6, friction=0.4, gravity=0.3, mass_ratio=0.2, damping=0.5, forcing=2.0, frequency=0.9
    )
    run = simulate(machine, {"w_rate": 0.7, "v": 0.4}, events=12)
    states, lengths = run.states[:-1][:12], run.lengths[:12]
    found, wanted = np.empty((2, len(states), 4))
    driven_measures._shapes(states, run.params, lengths, found)
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


def test_a_kernel_refuses_an_array_that_it_cannot_write():
    model = Absorber(restitution=0.76, friction=0.5, gravity=0.211)
    states = np.zeros((6, 2)).T
    with pytest.raises(TypeError, match="strides"):
        stepper("absorber").launch(np.zeros((6, 2))[:, 0], model.vector({"amplitude": 0.5}))
    stepper("absorber").energies(states, model.vector({"amplitude": 0.5}), np.empty(2))
