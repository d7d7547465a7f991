"""Surfaces of switches at which friction turns or sticks: an oscillator with dry friction and a soft stop, grazing as Den Hartog's amplitude says.

J. P. Den Hartog, Trans. ASME 53 (1931) APM-53-9: x'' + x = F cos(r t) - f sign(x') without sticks goes as far as
sqrt((F V)^2 - (f U)^2), V = 1 / (1 - r^2), U = sin(pi / r) / (r (1 + cos(pi / r))).
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
from orbits import DryFriction, Machine, Switch
from orbits.symbols import cos

pytestmark = pytest.mark.slow


def oscillator(**changed):
    def motion(state, phase, p, contact):
        x, v = state
        pressed = (1 + contact.stop) / 2
        return v, p.forcing * cos(phase) - x - p.stiffness * (x - p.gap) * pressed + contact.floor

    return Machine(
        name="stopped",
        states=("x", "v"),
        parameters={"forcing": 1.0, "frequency": 0.5, "friction": 0.3, "stiffness": 4.0, "gap": 1.15}
        | changed,
        phase_rate="frequency",
        motion=motion,
        contacts=[
            Switch("stop", lambda state, phase, p: state.x - p.gap),
            DryFriction("floor", lambda state, phase, p: state.v, "friction"),
        ],
    )


def amplitude(r, friction=0.3):
    v, u = 1 / (1 - r**2), np.sin(np.pi / r) / (r * (1 + np.cos(np.pi / r)))
    return np.sqrt(v**2 - (friction * u) ** 2)


def test_the_surface_moves_with_the_velocity_of_friction():
    machine = oscillator()
    assert machine.alphabet.rides == {(0, 1)}


@pytest.mark.parametrize(("gap", "friction"), [(1.6, 0.3), (2.2, 0.45)])
def test_a_turn_grazes_a_soft_stop_where_den_hartogs_amplitude_is_its_distance(gap, friction):
    machine = oscillator(gap=gap, friction=friction)
    graze = brentq(lambda r: amplitude(r, friction) - gap, 0.5, 0.95, xtol=1e-14)
    for start in ({"frequency": graze - 0.02}, {"frequency": graze + 0.02}):
        orbit = machine.attractor(**start)
        graph = cv.diagram(orbit, over="frequency", within=(graze - 0.03, graze + 0.03), depth=1)
        (point,) = [p for p in graph.special.values() if p.kind == "switch-graze"]
        assert point.value == pytest.approx(graze, abs=1e-10)
        words = {machine.word(b.description["word"]).canonical().events for b in graph.branches.values()}
        assert {machine.word("stop+ t stop- t").canonical().events} < words
        joined = {label for s in graph.switches if s.point == point.label for label in (s.source, s.target)}
        assert len(joined) == 2
