"""Attractors of the reduced absorber against closed forms and against the known route of the asymmetric branch."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from orbits import Absorber, Cavity
from orbits.attractors import find_attractor, find_attractors, sweep, sweeps
from orbits.simulation import simulate
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


def test_kinds():
    chatter = find_attractor(Absorber(restitution=0.3, friction=0.2, gravity=0.2), START, amplitude=8.0)
    assert chatter.kind == "chatter"
    assert chatter.periods == 1
    assert chatter.word is None
    assert find_attractor(MACHINE, START, amplitude=np.sqrt(5.0)).kind == "chaotic"
    free = Absorber(restitution=0.8, friction=0.0, gravity=0.2)
    assert find_attractor(free, {"phase": 0.0, "w_rate": 0.3}, amplitude=0.3).kind == "sliding"
    with pytest.raises(ValueError, match="chatter"):
        _ = chatter.found


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
        assert abs(known.shift) < 1e-12 and known.moved < 1e-12
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
