"""A family hands out orbits that can be continued, whatever they come from."""

import numpy as np
import pytest

from orbits import Orbit
from orbits.design import Family
from tests.machines import ABSORBER


def closed_form(amplitude, restitution):
    """Velocity B at the impacts of LR at Omega = 1: amplitude^2 = (1 - pi beta/2)^2 + (R beta + H)^2, larger root."""
    R, H = (1 - restitution) / (1 + restitution), np.pi / 2 * 1.006 * 0.5 * 0.211
    return max(np.roots([np.pi**2 / 4 + R * R, 2 * R * H - np.pi, 1 + H * H - amplitude**2]))


@pytest.mark.parametrize("restitution", [0.7, 0.76])
def test_its_orbits_are_those_of_the_closed_form_and_can_be_continued(restitution):
    machine = ABSORBER
    family = Family(machine, word="LR", loose={"amplitude": 0.55})
    orbit = family({"restitution": restitution})
    assert isinstance(orbit, Orbit)
    assert orbit.measure("B") == pytest.approx(closed_form(0.55, restitution), abs=1e-12)
    u, p = orbit.seed(orbit.problem("amplitude"))
    assert p == pytest.approx(0.55) and np.isfinite(u).all()
