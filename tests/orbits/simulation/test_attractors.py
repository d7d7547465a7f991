"""Attractors of the reduced absorber against closed forms and against the known route of the asymmetric branch."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from orbits import Absorber, Cavity, Coupled
from orbits.attractors import find_attractor, find_attractors, sweep, sweeps
from orbits.simulation import simulate
from orbits.starts.find import polish
from tests.machines import ABSORBER
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact

EPS, MU, G, R = 0.006, 0.5, 0.211, 0.76
A = (1 + EPS) * MU * G
H = np.pi / 2 * A
MACHINE = Absorber(restitution=R, friction=MU, gravity=G, mass_ratio=EPS)
START = {"w_rate": 1.0}


def test_symmetric_impacts_follow_the_closed_form():
    """C sin Psi = 1 - (pi/2) beta, C cos Psi = R beta + H on the branch that ends in the symmetry breaking."""
    loss = (1 - R) / (1 + R)
    fold = (2 * np.pi - 4 * loss * H) / (np.pi**2 + 4 * loss**2)
    values = (0.2, 0.35, 0.51)  # swept, since at 0.51 an orbit of three periods lives beside this one
    for c2, row in zip(values, sweep(MACHINE, "amplitude", np.sqrt(values), start=START)):
        beta = brentq(lambda b, c2=c2: (1 - np.pi * b / 2) ** 2 + (loss * b + H) ** 2 - c2, fold, 3.0)
        found = row.detail
        assert (found.text, found.periods, found.symmetric) == ("LR", 1, True)
        assert found.residual < 1e-13
        phases = found.nodes[:, 0]
        assert np.abs(np.sqrt(c2) * np.sin(phases)) == pytest.approx(abs(1 - np.pi * beta / 2), abs=1e-12)
        assert np.abs(np.sqrt(c2) * np.cos(phases)) == pytest.approx(loss * beta + H, abs=1e-12)
        assert np.prod(found.multipliers).real == pytest.approx(R**4, rel=1e-7)  # r^2 per impact


def test_symmetry_breaks_where_it_should():
    below = find_attractor(MACHINE, START, transient=20000, amplitude=np.sqrt(0.5282903 - 2e-5))
    above = find_attractor(MACHINE, START, transient=20000, amplitude=np.sqrt(0.5282903 + 2e-5))
    assert below.text == above.text == "LR"
    assert below.symmetric
    assert not above.symmetric
    assert np.abs(above.multipliers).max() == pytest.approx(1.0, abs=1e-3)


def test_route_of_the_asymmetric_branch():
    """A stick appears between 0.72 and 0.74, then stick and turn, two turns just below 0.80, doubling near 1.128."""
    values = np.array([0.6, 0.72, 0.74, 0.78, 0.795, 0.80, 0.9, 1.0, 1.1, 1.12, 1.127, 1.1295, 1.14])
    rows = sweep(MACHINE, "amplitude", np.sqrt(values), start=START, transient=1500)
    told = dict(zip(values, ((row.detail.word.canonical().text, row.periods) for row in rows)))
    assert told[0.6] == told[0.72] == ("LR", 1)
    assert told[0.74][0].count("s") == 1 and "t" not in told[0.74][0]
    assert sorted(told[0.78][0]) == sorted(told[0.795][0]) == sorted("LRst")
    for c2 in (0.80, 0.9, 1.0, 1.1, 1.12, 1.127):
        assert sorted(told[c2][0]) == sorted("LRtt")
        assert told[c2][1] == 1
    assert told[1.1295][1] == told[1.14][1] == 2
    assert rows[-1].impacts == 4
    assert not any(row.detail.symmetric for row in rows)
    # extrapolated multiplier -1
    (one, two) = (min(rows[i].detail.multipliers.real) for i in (9, 10))
    doubling = 1.12 + 0.007 * (one + 1.0) / (one - two)
    assert doubling == pytest.approx(1.128, abs=5e-4)
    # a stick forgets: one multiplier is 0
    assert np.abs(rows[2].detail.multipliers).min() < 1e-7


def test_determinant_of_words_with_turns():
    """det A = prod r^2 over impacts * prod (|v''| - a)/(|v''| + a) over turns."""
    for c2 in (0.9, 1.1, 1.3, 1.7, 9.0):
        found = find_attractor(MACHINE, START, amplitude=np.sqrt(c2))
        assert found.periods == 1
        pull = np.sqrt(c2) * np.abs(np.sin(found.nodes[found.codes == 2, 0]))
        told = R ** (2 * found.impacts) * np.prod((pull - A) / (pull + A))
        assert np.prod(found.multipliers).real == pytest.approx(told, rel=1e-6)


def test_sliding_lives_between_its_bounds():
    low, high = H**2 * (1 + 4 / np.pi**2), 1 + H**2
    assert find_attractor(MACHINE, amplitude=np.sqrt(low * (1 - 1e-6))).word.events == ("s", "u", "s", "u")
    above = find_attractor(MACHINE, amplitude=np.sqrt(low * (1 + 1e-6)))
    assert above.text == "tt"
    assert above.kind == "sliding"
    c = np.sqrt(high * (1 - 1e-10))  # started on the orbit: turning point delta = sqrt(C^2 - H^2)
    start = {"phase": np.arccos(H / c), "w": np.sqrt(c**2 - H**2)}
    run = simulate(MACHINE, start, periods=10, amplitude=c)
    assert set(run.letters) == {"t"}
    assert np.abs(run.rows[:, 2]) == pytest.approx(start["w"], abs=1e-12)
    grown = simulate(MACHINE, start, periods=10, amplitude=np.sqrt(high * (1 + 1e-6)))
    assert grown.impacts > 0
    assert find_attractor(MACHINE, amplitude=A * (1 - 1e-9)).kind == "stuck"


def test_mirror_images_are_one():
    found = find_attractor(MACHINE, START, amplitude=np.sqrt(0.6))
    image = find_attractor(MACHINE, {"phase": np.pi, "w_rate": -1.0}, amplitude=np.sqrt(0.6))
    assert not found.symmetric
    assert np.abs(found.nodes - image.nodes).max() > 0.01
    assert found.distance(image) < 1e-10
    other = find_attractor(MACHINE, START, amplitude=np.sqrt(0.61))
    assert 1e-6 < found.distance(other) < 1.0


def test_kinds():
    chatter = find_attractor(Absorber(restitution=0.3, friction=0.2, gravity=0.2), START, amplitude=8.0)
    assert chatter.kind == "chatter"
    assert chatter.periods == 1
    assert chatter.word is None
    assert find_attractor(MACHINE, START, amplitude=np.sqrt(5.0)).kind == "chaotic"
    free = Absorber(restitution=0.8, friction=0.0, gravity=0.2)
    assert find_attractor(free, {"phase": 0.0, "w_rate": 0.3}, amplitude=0.3).kind == "sliding"
    with pytest.raises(ValueError, match="chatter"):
        _ = chatter.orbit


def test_results_do_not_depend_on_the_number_of_workers():
    runs = [np.sqrt([0.6, 0.75, 0.9]), np.sqrt([0.9, 0.75, 0.6])]
    alone = sweeps(MACHINE, "amplitude", runs, start=START)
    shared = sweeps(MACHINE, "amplitude", runs, start=START, workers=2)
    assert [row.direction for row in alone[1]] == ["down"] * 3
    for one, two in zip(alone, shared):
        for a, b in zip(one, two):
            assert (a.word, a.measures) == (b.word, b.measures)
            assert np.array_equal(a.detail.nodes, b.detail.nodes)
    starts = [{"w_rate": 0.1 * i} for i in range(5)]
    first = find_attractors(MACHINE, starts, amplitude=0.7)
    again = [find_attractor(MACHINE, start, amplitude=0.7) for start in starts]
    assert all(np.array_equal(a.nodes, b.nodes) for a, b in zip(first, again))


def test_rows_of_a_stuck_absorber_wait_for_the_oscillator():
    """Lightly damped, it rings for a thousand periods; its linear response is known."""
    eps, forcing, damping = 0.006, 1.0, 0.9
    machine = Coupled(
        restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=eps, damping=damping, forcing=forcing
    )
    for row in sweep(machine, "frequency", [0.9, 0.93, 0.95], transient=50):
        drag = eps * damping * row.value
        response = eps * forcing * abs(1.0 + 1j * drag) / abs(1.0 - (1.0 + eps) * row.value**2 + 1j * drag)
        assert row.attractor == "stuck"
        assert row.measures["max_abs_q1"] == pytest.approx(response, rel=1e-9)


def test_rows_of_a_periodic_motion_are_those_of_its_orbit():
    """Measured on the solved orbit: largest |q1| and approach speed as Newton's method on the maps has them."""
    machine = Coupled(
        restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, damping=0.9, forcing=3.3
    )
    rows = sweep(machine, "frequency", [0.977, 0.983], start={"v": 1.0, "w_rate": 0.5}, transient=100)
    assert [row.attractor for row in rows] == ["periodic", "periodic"]
    for row in rows:
        orbit = polish(row.detail.orbit)
        fine = orbit.sample(20000)
        assert row.measures["max_abs_q1"] == pytest.approx(np.abs(fine["cavity"]).max(), rel=1e-8)
        hits = [letter in "LR" for letter in orbit.word.events]
        assert row.measures["impact_speed"] == pytest.approx(
            np.abs(orbit.events.rate_pre[hits]).max(), rel=1e-9
        )


def test_a_slow_transient_beside_a_symmetry_breaking_is_no_chaos():
    """C just above the symmetry breaking of `LR`, where its closed form has it; reached from below, on the symmetric orbit."""
    machine = ABSORBER
    breaking = np.sqrt(0.5282903)
    rows = sweep(machine, "amplitude", [breaking - 1e-3, breaking + 6e-5])
    assert [row.attractor for row in rows] == ["periodic", "periodic"]
    assert [row.detail.symmetric for row in rows] == [True, False]


def test_a_slow_alternating_approach_is_no_doubled_period():
    """Beside a period doubling: the multiplier of LRLt is -0.99887 in many digits, so that it is the attractor, and nothing of twice its period."""
    drawn = draw("absorber", 405, 121)
    values = {"amplitude": 1.1306491017684182}
    rng = np.random.default_rng([405, 121])
    assert rng.uniform(*drawn.options["within"]) == values["amplitude"]
    start = drawn.machine.random_start(drawn.machine.vector(values), rng)
    for patience in (1, 2):
        found = find_attractor(drawn.machine, start, max_period=4, patience=patience, **values)
        assert (found.orbit.spelling, found.periods) == ("LRLt", 1)
        known = exact(found.orbit)
        assert abs(known.shift) < 1e-14 and known.moved < 1e-12
        assert np.abs(known.multipliers).max() < 0.9989


@pytest.mark.parametrize("excess", [1e-4, 1e-3, 3e-2])
def test_a_motion_that_creeps_down_a_slope_ends_at_the_wall(excess):
    """Once in a period shaking beats friction, in one direction: the way is that of a slipping block, and is never taken back."""
    machine = Cavity(restitution=0.5, friction=0.9, gravity=0.8, slope=0.15, distance_left=1.4)
    pull = 0.8 * (0.9 * np.cos(0.15) - np.sin(0.15))
    amplitude = (1.0 + excess) * pull
    begin = np.arcsin(pull / amplitude)

    def speed(psi):
        return amplitude * (np.cos(begin) - np.cos(psi)) - pull * (psi - begin)

    end = brentq(speed, np.pi - begin + 1e-9, 2.0 * np.pi)
    way = quad(speed, begin, end, epsabs=1e-15)[0]
    run = simulate(machine, {"w": 0.5}, periods=20, amplitude=amplitude)
    places = run.sample(per_period=1).w
    assert np.diff(places[2:-1]) == pytest.approx(-way, rel=1e-6)
    found = find_attractor(machine, {"w": 0.5}, amplitude=amplitude)
    assert found.kind == "stuck"
    assert found.state[1] == pytest.approx(-1.0, abs=1e-9)
