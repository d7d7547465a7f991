"""Cycles as plain data: the group of their descriptions, and the empty word among them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import FACTORIES, Cavity, Orbit, OrbitProblem, Word
from orbits.cycle import Cycle, canonical, is_symmetric
from orbits.problem import rebuild
from tests.machines import ABSORBER, COUPLED

WORDS = ["LR", "RLtL", "LRLR", "LRs", "tt", "LttR"]


def drawn(model, text, periods, seed):
    word = Word.parse(text)
    generator = np.random.default_rng(seed)
    nodes = generator.uniform(-0.9, 0.9, (len(word), model.node))
    nodes[:, 0] = np.sort(generator.uniform(0.0, 2.0 * np.pi * periods, len(word)))
    loose = {"amplitude": 0.6} if model.name == "absorber" else {}
    return Cycle(model, word, periods, nodes, model.vector(loose))


@settings(max_examples=60, deadline=None)
@given(
    model=st.sampled_from([ABSORBER, COUPLED]),
    text=st.sampled_from(WORDS),
    periods=st.integers(1, 3),
    seed=st.integers(0, 999),
    places=st.integers(0, 7),
    times=st.integers(1, 3),
)
def test_rotations_mirror_and_repetition_are_one_cycle(model, text, periods, seed, places, times):
    cycle = drawn(model, text, periods, seed)
    key, form = canonical(cycle.word, cycle.periods, cycle.nodes)
    for other in (cycle.rotate(places), cycle.mirror(), cycle.repeat(times), cycle.mirror().rotate(places)):
        same, again = canonical(other.word, other.periods, other.nodes)
        assert same == key and np.abs(again - form).max() < 1e-12
    assert cycle.repeat(times).root().periods == cycle.periods
    assert np.isclose(cycle.durations.sum(), 2.0 * np.pi * periods)
    assert type(Orbit.of(cycle).rotate(1)) is Orbit


def test_mirrored_twice_is_a_forcing_period_later():
    cycle = drawn(COUPLED, "RLtL", 1, 3)
    shift = cycle.mirror().mirror().nodes - cycle.nodes
    assert np.allclose(shift, [2.0 * np.pi, 0.0, 0.0, 0.0])


def test_a_mirror_image_after_whole_forcing_periods_is_no_symmetry():
    """The mirror turns the forcing round, which half a period on is itself again only if that is an odd number of half turns."""
    for periods in (1, 2, 3):
        nodes = np.array([[0.3, 1.0], [0.3 + periods * np.pi, -1.0]])
        assert is_symmetric(Word.parse("LR"), periods, nodes) is (periods != 2)


@pytest.mark.parametrize(("text", "amplitude"), [("LR", 0.6), ("tt", 0.5)])
def test_multipliers_are_the_squares_of_those_of_half_a_symmetric_cycle(text, amplitude):
    orbit = ABSORBER.orbit(text, amplitude=amplitude)
    squares = np.sort_complex(orbit.half_multipliers**2)
    assert squares == pytest.approx(np.sort_complex(orbit.multipliers), abs=1e-10)


# ---------------------------------------------------------------------------------------------- the empty word
@pytest.mark.parametrize("frequency", [0.9, 0.97, 1.05])
def test_at_rest_the_oscillator_answers_linearly(frequency):
    """(1 + eps) q1'' + eps lambda q1' + q1 = eps G Im[(1 + i eps lambda Omega) exp(i Psi)], from the equations of motion."""
    machine = COUPLED.changed(forcing=0.05)
    orbit = machine.orbit("", frequency=frequency)
    eps, lam = machine.mass_ratio, machine.damping
    drag = eps * lam * frequency
    size = abs(eps * 0.05 * (1 + 1j * drag) / (1 - (1 + eps) * frequency**2 + 1j * drag))
    assert isinstance(orbit, Orbit) and len(orbit.word) == 0 and orbit.nodes.shape == (0, 4)
    assert orbit.measure("max_abs_q1") == pytest.approx(size, rel=1e-12)
    assert orbit.margin == pytest.approx(0.5 * 0.211 - frequency**2 * size, rel=1e-12)
    roots = np.roots([1 + eps, eps * lam, 1.0])
    expected = np.sort_complex(np.exp(2 * np.pi * roots / frequency))
    assert np.abs(np.sort_complex(orbit.multipliers) - expected).max() < 1e-13
    assert orbit.real and orbit.stable and orbit.symmetric and orbit.replay() < 1e-12
    assert np.abs(orbit.sample()["cavity"]).max() == pytest.approx(size, rel=1e-4)


def test_rest_on_a_slope_gives_way_downhill_first():
    machine = Cavity(restitution=0.76, friction_left=0.3, friction_right=0.5, gravity=0.4, slope=0.1)
    orbit = machine.orbit("", amplitude=0.02)
    g, a = 0.4 * np.cos(0.1), 0.4 * np.sin(0.1)
    # downhill is to the right wall: friction_right against the slope's pull, friction_left helped by it
    assert orbit.margin == pytest.approx(min(0.3 * g + a, 0.5 * g - a) - 0.02, abs=1e-14)
    assert not orbit.symmetric


@pytest.mark.parametrize("name", sorted(n for n, at in FACTORIES.items() if at.startswith("orbits.problem")))
def test_descriptions_of_every_version_open(name):
    told = COUPLED.changed(forcing=0.05).orbit("", frequency=0.97).problem("frequency").describe()
    for key in ("events", "modes", "frictionless"):  # version 0.1 kept none for the absorber at rest
        told.pop(key)
    again = rebuild({**told, "factory": name})
    assert isinstance(again, OrbitProblem) and again.parameter == "frequency" and len(again.word) == 0


def test_half_a_cycle_that_takes_another_time_is_no_root():
    """The second pair comes a forcing period after the first, the first again two after the second."""
    nodes = np.array([[0.5, 1.0], [2.0, -1.0], [0.5 + 2.0 * np.pi, 1.0], [2.0 + 2.0 * np.pi, -1.0]])
    cycle = Cycle(ABSORBER, Word.parse("LRLR"), 3, nodes, ABSORBER.vector({"amplitude": 0.6}))
    assert cycle.root().periods == 3 and len(cycle.root().word) == 4
    assert len(Cycle(ABSORBER, cycle.word, 2, nodes, cycle.params).root().word) == 2
