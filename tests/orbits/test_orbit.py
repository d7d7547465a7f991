"""Orbits: closed forms, determinant identities, long words, mirror images, energy."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import contvines as cv
from orbits import Absorber
from orbits.attractors import find_attractors, sweep
from orbits.theory.manifolds import activation, friction_level, impact_loss, sliding_bounds, turning_point
from tests.machines import ABSORBER, STRONG

machines = st.builds(
    Absorber,
    restitution=st.floats(0.15, 1.0),
    friction=st.floats(0.0, 0.8),
    gravity=st.floats(0.05, 0.4),
    mass_ratio=st.floats(0.0, 0.05),
    frequency=st.floats(0.5, 2.0),
)


def numbers(machine):
    R = impact_loss(machine.restitution)
    H = friction_level(machine.friction, machine.gravity, machine.mass_ratio) / machine.frequency**2
    return float(R), float(H)


@settings(max_examples=60, deadline=None)
@given(machines, st.floats(0.0, 1.0))
def test_closed_form_solves_the_maps(machine, above):
    R, H = numbers(machine)
    assume(H * R < 1.2)
    orbit = machine.symmetric_orbit(np.sqrt(float(activation(R, H).amplitude) ** 2 + above))
    assert orbit.residual < 1e-12 * (1.0 + orbit.nodes.max())
    assert orbit.symmetric


def test_determinant_with_turns():
    """det A = prod r^2 over impacts * prod (|v''| - a)/(|v''| + a) over turns."""
    orbit = ABSORBER.orbit("LRtt", amplitude=0.95)
    turns = orbit.nodes[[letter == "t" for letter in orbit.word.events], 0]
    shaking, a = np.abs(0.95 * np.sin(turns)), 1.006 * 0.5 * 0.211
    wanted = 0.76**4 * np.prod((shaking - a) / (shaking + a))
    assert np.prod(orbit.multipliers).real == pytest.approx(wanted, rel=1e-10)


@pytest.mark.parametrize("amplitude", [0.55, 0.8])
@pytest.mark.parametrize("times", [2, 16, 256])
def test_long_words_lose_nothing(times, amplitude):
    """Of a stable orbit and of one that is not, found again from nodes beside its own."""
    orbit = ABSORBER.symmetric_orbit(amplitude)
    long = orbit.repeat(times)
    beside = long.nodes + 1e-6 * np.random.default_rng(1).standard_normal(long.nodes.shape)
    again = ABSORBER.orbit(long.word, times, beside, amplitude=amplitude)
    np.testing.assert_allclose(again.nodes, long.nodes, atol=1e-9)
    assert long.residual < 1e-12
    # powers in logarithms: the numbers themselves underflow
    np.testing.assert_allclose(
        np.log(np.abs(long.multipliers)), times * np.log(np.abs(orbit.multipliers)), rtol=1e-11
    )


@settings(max_examples=25, deadline=None)
@given(st.floats(0.3, 1.2), st.integers(0, 3))
def test_descriptions_of_one_orbit_agree(amplitude, places):
    orbit = ABSORBER.symmetric_orbit(amplitude)
    for other in (orbit.mirror(), orbit.rotate(places), orbit.repeat(3)):
        assert other.residual < 1e-11
        problem, twin = orbit.problem(), other.problem(symmetric=False)
        key, vector = problem.canonical(*orbit.seed(problem))
        key2, vector2 = twin.canonical(*other.seed(twin))
        assert key == key2
        np.testing.assert_allclose(vector, vector2, atol=1e-10)


def test_losses_balance_the_work_of_the_cavity():
    """Work of the shaking on the relative motion, by quadrature of the samples, against the losses."""
    orbit = ABSORBER.symmetric_orbit(0.6)
    s = orbit.sample(40001)
    inside = np.diff(s["segment"]) == 0
    # d(w'^2/2)/dtau = w' v'' - a |w'|; per unit of m/(1 + eps)
    push = -0.6 * np.sin(s["phase"]) * s["w_rate"]
    work = np.sum(0.5 * (push[1:] + push[:-1]) * np.diff(s["tau"]) * inside) / 1.006
    assert orbit.measure("impact_loss") + orbit.measure("friction_loss") == pytest.approx(work, rel=1e-7)
    assert np.abs(s["w"]).max() <= 1.0 + 1e-12
    np.testing.assert_allclose(s["cavity"] - s["absorber"], s["w"], atol=1e-12)


def test_sliding_and_stick_slip_closed_forms_are_real_orbits():
    low, high = (float(x) ** 2 for x in sliding_bounds(friction_level(0.5, 0.211, 0.006)))
    for square, word in (
        (0.5 * (low + high), "tt"),
        (1.01 * low, "tt"),
        (0.99 * low, "ss"),
        (0.5 * low, "ss"),
    ):
        orbit = ABSORBER.orbit(word, amplitude=np.sqrt(square))
        assert orbit.real and orbit.symmetric and orbit.residual < 1e-12
        assert len(orbit.multipliers) == 1 and abs(orbit.multipliers[0]) < 1.0


def test_without_friction_words_need_no_turns():
    """The same physical motion for a -> 0: three impacts, once with a turn (small a), once without (a = 0)."""
    free = Absorber(**STRONG | {"friction": 0.0})
    rough = free.changed(friction=1e-7)
    guess = rough.orbit("LRtR", amplitude=1.35)
    hits = [i for i, letter in enumerate(guess.word.events) if letter in "LR"]
    smooth = free.orbit("LRR", amplitude=1.35, guess=guess.nodes[hits])
    assert smooth.real and guess.real
    np.testing.assert_allclose(smooth.nodes, guess.nodes[hits], atol=1e-5)
    np.testing.assert_allclose(
        np.sort(np.abs(smooth.multipliers)), np.sort(np.abs(guess.multipliers)), rtol=1e-5
    )


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_guess_tells_the_direction_of_a_sliding_motion(way):
    """`tt` leaves open whether it slides to the left first; the turning points are at +-sqrt(C^2 - h^2)."""
    amplitude = np.sqrt(0.3)
    turning = float(turning_point(amplitude, friction_level(0.5, 0.211, 0.006)))
    phase = 4.403 if way > 0.0 else 4.403 + np.pi
    guess = [[phase, -0.5 * way], [phase + np.pi, 0.5 * way]]
    orbit = ABSORBER.orbit("tt", amplitude=amplitude, guess=guess)
    assert orbit.real
    assert orbit.nodes[:, 1] == pytest.approx([-way * turning, way * turning], abs=1e-12)


def test_diagrams_sweeps_and_attractors_spell_a_motion_alike():
    orbit = ABSORBER.orbit("RLtL", amplitude=1.2)
    graph = cv.diagram(orbit, over="amplitude", within=(1.19, 1.21), depth=0)
    found = find_attractors(ABSORBER, [{"w_rate": 1.0}, {"w_rate": -1.0}, None], amplitude=1.2)
    rows = sweep(ABSORBER, "amplitude", [1.2, 1.201])
    spellings = {graph.branches["B1"].description["word"], orbit.to_dict()["word"], orbit.spelling}
    spellings |= {attractor.text for attractor in found} | {row.word for row in rows}
    assert spellings == {"LRLt"}
    assert all("word='LRLt'" in repr(attractor) for attractor in found)
    assert orbit.to_dict()["events"] == "RLtL"  # in the order of the nodes
