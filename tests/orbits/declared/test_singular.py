"""Where a page's formula is no number, the sentence names it, its line and the state."""

import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits import Machine, Switch, Wall
from orbits.flows.page.stepper import SimulationError
from orbits.machines.page.singular import singular_at
from orbits.symbols import cos, sqrt


def shaft() -> Machine:
    """Motion divides by the distance from the middle, where the machine is at rest."""

    def motion(s, phase, p, contact):
        push = p.ring * (1 - 1 / sqrt(s.x**2 + s.y**2)) * (1 + contact.rub) / 2
        return s.vx, cos(phase) - s.vx - s.x - push * s.x, s.vy, -s.vy - s.y - push * s.y

    return Machine(
        name="shaft",
        states=("x", "vx", "y", "vy"),
        parameters={"speed": 1.2, "ring": 30.0},
        phase_rate="speed",
        motion=motion,
        contacts=[Switch("rub", lambda s, phase, p: s.x**2 + s.y**2 - 1)],
    )


@pytest.mark.parametrize("run", [lambda m: m.attractor(), lambda m: m.simulate({"vx": 0.0}, periods=2)])
def test_a_rest_start_that_divides_by_zero_is_named(run):
    with pytest.raises(SimulationError) as refused:
        run(shaft())
    said = str(refused.value)
    assert "motion has a division by zero" in said and "push = p.ring * (1 - 1 / sqrt" in said
    assert "x = 0, vx = 0, y = 0, vy = 0, phase = 0" in said and "start elsewhere" in said


def stop(motion=None, gap=None) -> Machine:
    return Machine(
        name="stop",
        states=("x", "v"),
        parameters={"rate": 1.2, "gap": 1.0},
        phase_rate="rate",
        motion=motion or (lambda s, phase, p, contact: (s.v, cos(phase) - s.x)),
        contacts=[Wall("R", gap or (lambda s, phase, p: p.gap - s.x), {"v": -1.0}, 0.7)],
    )


def named(machine: Machine, x: float, v: float) -> str:
    return singular_at(machine.equations, machine.vector(), (0,), np.array([x, v]), 0.5)


def test_formulas_of_contacts_and_slopes_are_named_too():
    assert named(stop(), 0.0, 0.0) == ""
    hyperbolic = stop(gap=lambda s, phase, p: 1 / (s.x + 2) - p.gap / 4)
    assert named(hyperbolic, 0.0, 0.0) == ""
    assert named(hyperbolic, -2.0, 0.0).startswith("the gap of wall 'R' has a division by zero")
    rooted = stop(motion=lambda s, phase, p, contact: (s.v, cos(phase) - sqrt(s.x + 1)))
    assert "motion has no number" in named(rooted, -2.0, 0.0)
    assert named(rooted, -1.0, 0.0).startswith("motion has no slopes")
    assert named(rooted, -1.0, 0.0).endswith("at x = -1, v = 0, phase = 0.5")
