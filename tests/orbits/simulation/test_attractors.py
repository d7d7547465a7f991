"""Attractors of the built-in machines against closed forms and against the known route of the asymmetric branch."""

import numpy as np
import pytest

from orbits import Absorber
from orbits.attractors import find_attractor, find_attractors, sweep, sweeps
from tests.machines import ABSORBER, COUPLED
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact

BREAKING = 0.5282903  # C^2 of the symmetry breaking of LR, by its closed form
START = {"w_rate": 1.0}


def test_symmetric_impacts_follow_the_closed_form():
    values = np.sqrt(
        (0.2, 0.35, 0.51)
    )  # swept, since at the last an orbit of three periods lives beside this one
    for value, row in zip(values, sweep(ABSORBER, "amplitude", values, start=START)):
        found, known = row.detail, ABSORBER.symmetric_orbit(amplitude=value)
        assert (found.text, found.periods, found.symmetric) == ("LR", 1, True)
        assert found.residual < 1e-13
        own, other = (np.abs([np.sin(nodes[:, 0]), nodes[:, 1]]) for nodes in (found.nodes, known.nodes))
        assert own == pytest.approx(other, abs=1e-12)
        assert np.prod(found.multipliers).real == pytest.approx(0.76**4, rel=1e-7)  # r^2 per impact


def test_symmetry_breaks_where_it_should():
    """A slow transient just above, swept from below, on the symmetric orbit, is no chaos."""
    below, above = (
        find_attractor(ABSORBER, START, transient=20000, amplitude=np.sqrt(BREAKING + off))
        for off in (-2e-5, 2e-5)
    )
    rows = sweep(ABSORBER, "amplitude", np.sqrt(BREAKING) + np.array([-1e-3, 6e-5]))
    assert [row.attractor for row in rows] == ["periodic", "periodic"]
    found = [below, above, *(row.detail for row in rows)]
    assert [(one.text, one.symmetric) for one in found] == [("LR", True), ("LR", False)] * 2
    assert np.abs(above.multipliers).max() == pytest.approx(1.0, abs=1e-3)


def test_kinds():
    chatter = find_attractor(Absorber(restitution=0.3, friction=0.2, gravity=0.2), START, amplitude=8.0)
    assert (chatter.kind, chatter.periods, chatter.word) == ("chatter", 1, None)
    with pytest.raises(ValueError, match="chatter"):
        _ = chatter.found
    assert find_attractor(ABSORBER, START, amplitude=np.sqrt(5.0)).kind == "chaotic"
    free = Absorber(restitution=0.8, friction=0.0, gravity=0.2)
    assert find_attractor(free, {"w_rate": 0.3}, amplitude=0.3).kind == "sliding"


def test_different_attractors_are_each_listed_once():
    found = ABSORBER.attractors(30, seed=1, amplitude=0.3)
    assert sorted(one.text for one in found) == ["LR", "tt"]


@pytest.mark.parametrize(("frequency", "word"), [(0.985, "LR"), (0.99, "LRtt"), (1.0, "LRtR")])
def test_attractors_of_the_coupled_machine_become_orbits(frequency, word):
    found = find_attractor(COUPLED, {"q1": 1.0, "q2": 1.0}, frequency=frequency)
    orbit = COUPLED.orbit(word, frequency=frequency)
    assert found.kind == "periodic" and found.orbit.word.canonical() == orbit.word.canonical()
    assert orbit.real and orbit.stable and orbit.replay() < 1e-11


def test_results_do_not_depend_on_the_number_of_workers():
    runs = [np.sqrt([0.6, 0.75, 0.9]), np.sqrt([0.9, 0.75, 0.6])]
    alone, shared = (sweeps(ABSORBER, "amplitude", runs, start=START, workers=n) for n in (1, 2))
    assert [[row.direction for row in rows] for rows in alone] == [["up"] * 3, ["down"] * 3]
    for one, two in zip(alone, shared):
        for a, b in zip(one, two):
            assert (a.word, a.measures) == (b.word, b.measures)
            assert np.array_equal(a.detail.nodes, b.detail.nodes)
    starts = [{"w_rate": 0.1 * i} for i in range(5)]
    for start, found in zip(starts, find_attractors(ABSORBER, starts, amplitude=0.7)):
        assert np.array_equal(found.nodes, find_attractor(ABSORBER, start, amplitude=0.7).nodes)


def test_a_slow_alternating_approach_is_no_doubled_period():
    """Beside a period doubling: the multiplier of LRLt is -0.99887 in many digits, so that it is the attractor, and nothing of twice its period."""
    drawn = draw("absorber", 405, 121)
    rng = np.random.default_rng([405, 121])
    values = {"amplitude": rng.uniform(*drawn.options["within"])}
    start = drawn.machine.random_start(drawn.machine.vector(values), rng)
    for patience in (1, 2):
        found = find_attractor(drawn.machine, start, max_period=4, patience=patience, **values)
        assert (found.orbit.spelling, found.periods) == ("LRLt", 1)
        known = exact(found.orbit)
        assert abs(known.shift) < 1e-12 and known.moved < 1e-12
        assert np.abs(known.multipliers).max() < 0.9989
