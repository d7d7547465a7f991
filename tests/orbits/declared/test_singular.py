"""Where a page's formula is no number, the sentence names it, its line and the state."""

import pytest

pytest.importorskip("heyoka")

from orbits import Machine, Switch
from orbits.flows.page.stepper import SimulationError
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
