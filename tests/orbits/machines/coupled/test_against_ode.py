"""The coupled machine against numerical integration of its equations of motion (scipy's DOP853, events, differences).

Nothing of `orbits` takes part in the integration: the equations are written down here once more.
"""

import numpy as np
import pytest

from orbits.simulation import simulate
from tests.machines import COUPLED
from tests.orbits.machines.coupled.equations_of_motion import integrate

pytestmark = pytest.mark.slow

CASES = {
    "impacts": ({"frequency": 0.985}, {"q1": 1.0, "q2": 0.0}),
    "sliding": ({"frequency": 0.975}, {}),
    "stick-slip": ({"frequency": 0.94, "excitation": "truncated"}, {"q1": 0.05}),
    "turns, sticks and slips": (
        {
            "forcing": 3.0,
            "frequency": 0.98,
            "damping": 0.7,
            "mass_ratio": 0.3,
            "gravity": 0.29,
            "restitution": 0.95,
        },
        {"w": -0.2, "w_rate": 0.4, "v": 0.6, "v_rate": -0.3},
    ),
    "undamped": (
        {"forcing": 2.9, "frequency": 0.8, "damping": 0.0, "mass_ratio": 0.05, "friction": 0.1},
        {"w": 0.5, "w_rate": -0.4, "v": 0.9},
    ),
    "on a slope": ({"frequency": 0.985, "slope": 0.1}, {"q1": 1.0, "q2": 0.0}),
    "down a steep slope": (
        {"frequency": 0.9, "mass_ratio": 0.2, "slope": -0.7, "forcing": 1.2},
        {"w": 0.1, "w_rate": 0.3, "v": 0.2},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_simulated_events_are_those_of_the_integration(case):
    changes, start = CASES[case]
    machine = COUPLED.changed(**changes)
    params = machine.vector()
    count = 30
    run = simulate(machine, start, events=count)
    state = run.start
    eps = machine.mass_ratio
    w, rate, v, v_rate = state[1], state[2], state[6], state[7]
    y = [
        (v + eps * w) / (1 + eps),
        (v_rate + eps * rate) / (1 + eps),
        (v - w) / (1 + eps),
        (v_rate - rate) / (1 + eps),
    ]
    expected = integrate(params, 0.0, np.array(y), int(state[3]), count)
    assert run.letters == "".join(row[0] for row in expected)
    found = np.column_stack([run.phases, run.rows[:, [2, 3, 5, 6]]])
    np.testing.assert_allclose(found, np.array([row[1:] for row in expected]), atol=3e-9)


def test_stick_slip_at_the_published_detuning():
    """sigma = -9.04, from rest: the absorber sticks and slips."""
    machine = COUPLED.changed(frequency=1.0 - 9.04 * 0.006, damping=0.9)
    run = simulate(machine, {}, periods=1500)
    assert run.letters[-4:] in ("susu", "usus")
    orbit = machine.orbit("susu")
    assert orbit.real and orbit.stable
    slip = run.rows[run.codes == 4][-1]
    own = orbit.nodes[[i for i, letter in enumerate(orbit.word.events) if letter == "u"]]
    gaps = [abs(np.exp(1j * node[0]) - np.exp(1j * slip[0])) for node in own]
    assert min(gaps) < 1e-9


def test_a_stuck_start_stays_stuck_where_friction_holds():
    machine = COUPLED.changed(forcing=0.5, frequency=0.9)
    assert machine.stuck_response().real
    params = machine.vector()
    v, v_rate = machine.rest.cavity_motion(params, machine.rest.solved(params), np.zeros(1))
    run = simulate(machine, {"v": float(v[0]), "v_rate": float(v_rate[0])}, periods=50)
    assert run.codes.size == 0
