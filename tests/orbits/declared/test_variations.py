"""Derivatives of simulated motions of declared machines, against central differences of the simulation."""

import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits.flows import simulator_of
from orbits.simulation.runs import Section
from orbits.words import Word
from tools.pages.pages import page

CASES = [  # a switch; walls and friction; a wall that moves; impulses on three bodies
    ("elastic_stop", "stiffness", [0.9, 0.8]),
    ("elastic_stop", "frequency", [0.9, 0.8]),
    ("absorber", "friction", [0.2, 0.8]),
    ("absorber", "restitution", [-0.4, -2.0]),
    ("bouncing_ball", "amplitude", [0.3, -0.5]),
    ("bouncing_ball", "frequency", [0.3, -0.5]),
    ("two_absorbers", "mass", [0.1, 0.2, -0.1, 0.3, 0.5, -0.4]),
]


@pytest.mark.parametrize(("name", "parameter", "start"), CASES)
def test_derivatives_are_those_of_the_simulation(name, parameter, start):
    machine, x = page(name), np.array(start)
    value = dict(machine.parameters)[parameter]

    def section(**values):
        """Once per forcing period, at phase zero."""
        word = Word((), (tuple(0 for _ in machine.contacts),), machine.alphabet)
        simulator = simulator_of(machine, machine.vector(values))
        return Section(
            simulator, word, 1, np.ones(machine.size + 1), machine.parameter_names.index(parameter)
        )

    def difference(ahead, behind):
        return pytest.approx((ahead - behind) / 2e-5, rel=1e-6, abs=1e-6)

    here = section()
    image, by_state, by_value = here.varied(x)
    assert image == pytest.approx(here.step(x), abs=1e-13)
    for column, unit in zip(by_state.T, np.eye(machine.size)):
        assert column == difference(here.step(x + 1e-5 * unit), here.step(x - 1e-5 * unit))
    ahead, behind = (section(**{parameter: value + h}).step(x) for h in (1e-5, -1e-5))
    assert by_value == difference(ahead, behind)
