"""The coupled machine against numerical integration of its equations of motion (scipy's DOP853, events), of which nothing of `orbits` takes part."""

from dataclasses import replace

import numpy as np
import pytest

from orbits.machines.reference.machine import reference
from orbits.simulation import simulate
from tests.machines import COUPLED
from tests.orbits.machines.coupled.equations_of_motion import driven, integrate

pytestmark = pytest.mark.slow

FALLS = {"q1": 1.0, "q2": 0.0}
CASES = {
    "impacts": ({"frequency": 0.985}, FALLS),
    "sliding": ({"frequency": 0.975}, {}),
    "stick-slip": ({"frequency": 0.94, "excitation": "truncated"}, {"q1": 0.05}),
    "turns, sticks and slips": (
        {"forcing": 3.0, "frequency": 0.98, "damping": 0.7, "mass_ratio": 0.3, "gravity": 0.29, "restitution": 0.95},
        {"w": -0.2, "w_rate": 0.4, "v": 0.6, "v_rate": -0.3},
    ),
    "undamped": (
        {"forcing": 2.9, "frequency": 0.8, "damping": 0.0, "mass_ratio": 0.05, "friction": 0.1},
        {"w": 0.5, "w_rate": -0.4, "v": 0.9},
    ),
    "on a slope": ({"frequency": 0.985, "slope": 0.1}, FALLS),
    "down a steep slope": (
        {"frequency": 0.9, "mass_ratio": 0.2, "slope": -0.7, "forcing": 1.2}, {"w": 0.1, "w_rate": 0.3, "v": 0.2}
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_simulated_events_are_those_of_the_integration(case):
    changes, start = CASES[case]
    machine = COUPLED.changed(**changes)
    run = simulate(machine, start, events=30)
    eps, (_, w, rate, *_, v, v_rate) = machine.mass_ratio, run.start
    whole = np.array([v + eps * w, v - w, v_rate + eps * rate, v_rate - rate]) / (1 + eps)
    force, absorber = driven(machine.vector())
    expected = integrate(force, 1.0, [absorber], whole, 30)
    assert run.letters == "".join(event[0][0] for event in expected)
    rows = [
        [machine.frequency * t, q1 - q2, before, q1 + eps * q2, p1 + eps * p2]
        for _, t, (q1, q2, p1, p2), before in expected
    ]
    np.testing.assert_allclose(np.column_stack([run.phases, run.rows[:, [2, 3, 5, 6]]]), rows, atol=3e-9)
    assert abs(replace(run, machine=reference("coupled")).balance().error) < 1e-9


def test_stick_slip_at_the_published_detuning():
    """sigma = -9.04, from rest: the absorber sticks and slips."""
    machine = COUPLED.changed(frequency=1.0 - 9.04 * 0.006, damping=0.9)
    run = simulate(machine, {}, periods=1500)
    assert run.letters[-4:] in ("susu", "usus")
    orbit = machine.orbit("susu")
    assert orbit.real and orbit.stable
    own = orbit.nodes[[letter == "u" for letter in orbit.word.events], 0]
    assert np.abs(np.exp(1j * own) - np.exp(1j * run.rows[run.codes == 4][-1, 0])).min() < 1e-9
