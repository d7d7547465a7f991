"""The coupled machine against numerical integration of its equations of motion (scipy's DOP853, events, differences).

Nothing of `orbits` takes part in the integration: the equations are written down here once more.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from orbits.machines.closed_forms.coupled import stuck_state, symmetric_discriminant
from orbits.simulation import simulate
from tests.machines import COUPLED
from tests.orbits.machines.coupled.equations_of_motion import TIGHT, event, integrate, right_side

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


def half_map(params, x):
    """From just after an impact on the left to just after the next on the right, mirrored: (Psi, B, v, v') -> same."""
    _G, Omega, _lam, eps, r, _mu, _g, _chi, _slope = params
    psi, B, v, v_rate = x
    q2_rate = B / (1 + eps)
    y = [(v + eps) / (1 + eps), v_rate - eps * q2_rate, (v - 1) / (1 + eps), q2_rate]
    wall = event(lambda t, y: 1.0 + y[0] - y[2], -1.0)
    run = solve_ivp(right_side(params, -1), (psi / Omega, psi / Omega + 6.0), y, events=[wall], **TIGHT)
    assert run.status == 1
    q1, p1, q2, p2 = run.y[:, -1]
    v, v_rate = q1 + eps * q2, p1 + eps * p2
    return np.array([run.t[-1] * Omega - np.pi, -(v_rate + r * (p1 - p2)), -v, -v_rate])


def half_matrix(params, x):
    """The half map's derivative by central differences of fourth order."""
    columns = []
    for j in range(4):
        h = np.zeros(4)
        h[j] = 2e-4
        one = half_map(params, x + h) - half_map(params, x - h)
        two = half_map(params, x + 2 * h) - half_map(params, x - 2 * h)
        columns.append((8 * one - two) / (12 * h[j]))
    return np.array(columns).T


def solve(x, Omega):
    """The symmetric orbit LR at Omega from a guess, by Newton's method, and its half map's derivative."""
    params = COUPLED.vector({"frequency": Omega})
    for _ in range(12):
        M = half_matrix(params, x)
        step = np.linalg.solve(np.eye(4) - M, half_map(params, x) - x)
        x = x + step
        if np.abs(step).max() < 1e-11:
            return x, M
    raise AssertionError("Newton's method does not converge")


def critical(spectrum, kind):
    if kind == "symmetry-breaking":
        real = spectrum[np.abs(spectrum.imag) < 1e-8].real
        return float(real.min()) + 1.0
    pair = spectrum[(spectrum.imag > 1e-3) & (spectrum.real > 0.9)]
    return abs(pair[0]) - 1.0


@pytest.mark.parametrize(
    ("kind", "near", "published"),
    [
        ("symmetry-breaking", 0.9856, 0.98565),
        ("symmetry-breaking", 1.0038, 1.00378),
        ("neimark-sacker", 1.0254, 1.02541),
    ],
)
def test_bifurcations_of_the_symmetric_response(kind, near, published):
    orbit = COUPLED.symmetric_orbit(frequency=near)
    x = np.array(orbit.nodes[0])

    def by_integration(Omega):
        nonlocal x
        x, M = solve(x, Omega)
        return critical(np.linalg.eigvals(M), kind)

    def compiled(Omega):
        return critical(COUPLED.symmetric_orbit(frequency=Omega).half_multipliers, kind)

    a, b = near - 1e-4, near + 1e-4
    fa, fb = by_integration(a), by_integration(b)
    for _ in range(6):  # secant
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        if abs(b - a) < 1e-10:
            break
        fb = by_integration(b)
    expected = b
    assert expected == pytest.approx(published, abs=6e-6)
    assert brentq(compiled, near - 1e-4, near + 1e-4, xtol=1e-14) == pytest.approx(expected, abs=2e-9)


@pytest.mark.parametrize(
    ("inside", "outside", "published"), [(0.9719, 0.9716, 0.97172), (1.0279, 1.0282, 1.02804)]
)
def test_folds_of_the_symmetric_response(inside, outside, published):
    """Where the closed form's discriminant vanishes the integrated half map has a multiplier +1."""
    fold = brentq(
        lambda Omega: symmetric_discriminant(COUPLED.vector({"frequency": Omega})),
        inside,
        outside,
        xtol=1e-15,
    )
    assert fold == pytest.approx(published, abs=6e-6)
    # the multiplier passes +1 linearly in the velocity B, between the two orbits that meet in the fold
    Omega = fold + 1e-5 * np.sign(inside - fold)
    distances, places = [], []
    for fast in (True, False):
        orbit = COUPLED.symmetric_orbit(fast=fast, frequency=Omega)
        x, M = solve(np.array(orbit.nodes[0]), Omega)
        np.testing.assert_allclose(x, orbit.nodes[0], atol=1e-9)
        distances.append(np.linalg.det(M - np.eye(4)))
        places.append(x[1])
    assert distances[0] * distances[1] < 0.0
    slope = (distances[1] - distances[0]) / (places[1] - places[0])
    zero = places[0] - distances[0] / slope
    # Omega - fold ~ (B - B_fold)^2: the parabola through both orbits has its top at the zero of the determinant
    assert zero == pytest.approx(0.5 * (places[0] + places[1]), abs=0.02 * abs(places[0] - places[1]))


def test_multipliers_of_both_regimes_at_the_same_frequency():
    """Sliding from rest and impacts from q1 = q2 = b at sigma = -2.58: both stable, as simulated and as orbits."""
    Omega = 1.0 - 2.58 * 0.006
    machine = COUPLED.changed(frequency=Omega, damping=0.9)
    run = simulate(machine, {}, periods=1500)
    assert set(run.letters[-20:]) == {"t"}
    orbit = machine.orbit("tt")
    assert orbit.real and orbit.stable
    # the middle of the sliding is left to chance: compare q1 = (v + eps w)/(1 + eps)
    q1 = (orbit.nodes[:, 2] + 0.006 * orbit.nodes[:, 1]) / 1.006
    simulated = (run.rows[-2:, 5] + 0.006 * run.rows[-2:, 2]) / 1.006
    assert np.abs(q1).max() == pytest.approx(np.abs(simulated).max(), abs=1e-10)
    run = simulate(machine, {"q1": 1.0, "q2": 1.0}, periods=1500)
    assert run.letters[-4:] in ("LRLR", "RLRL")
    orbit = machine.orbit("LR")
    assert orbit.real and orbit.stable
    left = run.rows[run.codes == 0][-1]
    np.testing.assert_allclose(
        [orbit.nodes[0, 0], orbit.nodes[0, 2], orbit.nodes[0, 3]], left[[0, 5, 6]], atol=1e-9
    )


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
    run = simulate(machine, stuck_state(machine.vector()), periods=50)
    assert run.codes.size == 0


def test_period_doubling_behind_the_borders():
    """The asymmetric response with two turns in its long flight, `LRtt`, doubles: return map by integration."""

    def whole_map(params, x):
        """From just after an impact on the left to the next one: (Psi, B, v, v') -> same, through R, t, t."""
        _G, Omega, _lam, eps, r, _mu, _g, _chi, _slope = params
        psi, B, v, v_rate = x
        y = np.array(
            [(v + eps) / (1 + eps), v_rate - eps * B / (1 + eps), (v - 1) / (1 + eps), B / (1 + eps)]
        )
        rows = integrate(params, psi / Omega, y, -1, 4)
        assert "".join(row[0] for row in rows) == "RttL"
        _letter, phase, _w, before, v, v_rate = rows[-1]
        return np.array([phase - 2 * np.pi, v_rate + r * before, v, v_rate])

    def by_integration(Omega):
        nonlocal x
        params = COUPLED.vector({"frequency": Omega})
        for _ in range(8):
            columns = []
            for j in range(4):
                h = np.zeros(4)
                h[j] = 1e-5
                columns.append((whole_map(params, x + h) - whole_map(params, x - h)) / 2e-5)
            M = np.array(columns).T
            step = np.linalg.solve(np.eye(4) - M, whole_map(params, x) - x)
            x = x + step
            if np.abs(step).max() < 1e-9:
                break
        spectrum = np.linalg.eigvals(M)
        return float(spectrum[np.abs(spectrum.imag) < 1e-8].real.min()) + 1.0

    def compiled(Omega):
        nonlocal orbit
        orbit = COUPLED.orbit("LRtt", guess=orbit.nodes, frequency=Omega)
        multipliers = orbit.multipliers
        return float(multipliers[np.abs(multipliers.imag) < 1e-8].real.min()) + 1.0

    orbit = COUPLED.orbit("LRtt", frequency=0.9905)
    x = np.array(orbit.nodes[0])
    found = brentq(compiled, 0.9905, 0.9909, xtol=1e-13)
    assert orbit.real
    low, high = by_integration(found - 2e-5), by_integration(found + 2e-5)
    assert low * high < 0.0
    assert found - 2e-5 + 4e-5 * low / (low - high) == pytest.approx(found, abs=2e-7)
