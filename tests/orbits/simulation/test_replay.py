"""Replay of true and of false claims."""

from dataclasses import replace

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.attractors import find_attractor
from orbits.cycle import Cycle
from orbits.simulation import replay, simulate
from orbits.simulation.replaying import by_events
from orbits.words import Word
from tests.machines import ABSORBER
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact
from tools.fuzz.searching import LIMITS


def attractor(c2):
    return find_attractor(ABSORBER, {"w_rate": 1.0}, amplitude=np.sqrt(c2))


def test_an_unstable_orbit_is_tracked_as_long_as_it_can_be():
    told = replay(ABSORBER.symmetric_orbit(amplitude=np.sqrt(0.65)), thorough=True)
    assert told.error < 1e-12 and told.message == "" and told.returned is None
    assert np.abs(told.multipliers).max() > 1.05
    assert np.prod(told.multipliers).real == pytest.approx(0.76**4, rel=1e-6)
    assert told.tracked >= 0.8 * min(told.expected, 200)


@pytest.mark.parametrize("c2", [0.012, 0.03, 0.1, 0.3, 0.5, 0.6, 0.74, 0.75, 0.9, 1.14, 1.7])
def test_a_stable_orbit_is_found_again_and_every_event_can_be_the_first(c2):
    found = attractor(c2).found
    for k in range(len(found.word)):
        told = replay(found.rotate(k))
        assert told.error < 1e-11, (k, told.message)
    told = replay(found, thorough=True)
    assert (told.returned, told.tracked) == (True, 200) and told.error < 1e-12


def test_a_wrong_event_list_is_refused():
    found = attractor(0.9)
    assert sorted(found.text) == sorted("LRtt")
    impacts = found.word.codes < 2
    told = replay(Cycle(ABSORBER, Word.parse("LR"), 1, found.nodes[impacts], found.params))
    assert told.error == np.inf and not told.matches
    assert "is t, listed was" in told.message
    assert told.motion < 1e-12  # the same motion, told with other events


def test_an_ill_conditioned_orbit_attracts_although_it_is_known_less_well_than_starts_come_back():
    """Nodes that are off by 1e-7, as those of a steep orbit are by rounding: starts come to the orbit itself; off by 1e-5 they are no orbit's."""
    found = attractor(0.9).found
    for off, back in ((1e-7, True), (1e-5, False)):
        told = replay(replace(found, nodes=found.nodes + [0.0, off]), thorough=True)
        assert told.returned is back


@pytest.mark.slow
def test_an_orbit_to_which_only_starts_very_near_return_is_said_to_return():
    """Deviations grow a thousandfold on the way before they shrink; its multipliers are small in many digits."""
    machine = Absorber(restitution=0.6134455719320618, friction=0.0, gravity=0.4648360951073012)
    amplitude, phase, B = 1.249753219146763, 4.9755196858787105, 1.566737755212909
    start = {"phase": phase, "w": 1.0, "w_rate": amplitude * np.cos(phase) - B}
    one, other = (
        simulate(machine, start | {"w_rate": start["w_rate"] * by}, events=46, amplitude=amplitude).phases
        for by in (1.0, 1.0 + 1e-10)
    )
    gaps = np.abs(one - other)
    assert gaps.max() > 1e3 * gaps[0] and gaps[-1] < 1e-3 * gaps[0]  # gone after two rounds
    found = find_attractor(machine, start, amplitude=amplitude).orbit
    assert (found.periods, found.impacts) == (8, 23)
    known = exact(found)
    assert known.moved < 1e-12 and np.abs(known.multipliers).max() < 1e-3
    first = next(k for k, (_, speed) in enumerate(found.nodes) if speed == pytest.approx(B, abs=1e-6))
    assert replay(found.rotate(first), thorough=True).returned is True


@pytest.mark.parametrize(
    ("machine", "amplitude"),
    [
        (ABSORBER, 0.55),
        (ABSORBER.changed(frequency=1.4), 0.55),
        (
            Cavity(restitution=0.6, friction=0.1, gravity=0.2, slope=0.1, frequency=0.7, distance_left=1.7),
            1.4,
        ),
    ],
    ids=["units of one", "another frequency", "another cavity"],
)
def test_a_cycle_comes_back_to_where_it_met_the_section(machine, amplitude):
    orbit = machine.orbit("LR", amplitude=amplitude)
    problem = orbit.problem("amplitude")
    u, p = orbit.seed(problem)
    section = problem.section(p)
    (place,) = section.rounds(u)
    assert section.step(place) == pytest.approx(place, abs=1e-10)
    assert section.through(u) == pytest.approx(place, abs=1e-10)


@pytest.mark.slow
def test_orbits_on_which_rounding_grows_within_a_period_are_replayed_event_by_event():
    """A fold beside a graze of the absorber: deviations grow 1e14 times on the way and shrink again. Many digits say that it is an orbit."""
    drawn = draw("absorber", 404, 339)
    folds = cv.diagram(drawn.orbit, **drawn.options, settings=LIMITS).of_kind("fold")
    fold = min(folds, key=lambda p: abs(p.value - 1.8398599))
    known = exact(fold.orbit)
    assert known.moved < 1e-12 and abs(known.shift) < 1e-14
    assert fold.replay == fold.orbit.replay() < 1e-9
    nodes = fold.orbit.nodes.copy()
    nodes[5, 1] += 1e-4
    assert replace(fold.orbit, nodes=nodes).replay() > 5e-5
    through_walls = ABSORBER.orbit("tt", 1, amplitude=1.1)
    assert by_events(through_walls, 0, 1) == np.inf == through_walls.replay()
