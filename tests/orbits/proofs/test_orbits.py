"""Proofs of orbits against orbits known to 50 digits by another route, against the floating ones, and against wrong inputs."""

import json
import sys
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp

from orbits import Cavity, Coupled
from orbits.orbit import Orbit
from orbits.proofs.balls import ball, precision
from orbits.proofs.checker import Refused, check
from orbits.proofs.flights import Flights
from orbits.proofs.jets import Jet, base, partial
from orbits.proofs.obstacles import ProofError, Remedy
from orbits.proofs.prove import prove_stuck
from tests.machines import ABSORBER, COUPLED, STRONG
from tests.orbits.proofs.papers import checked, holds
from tools.proofs import fifty_digits, tampering

pytestmark = pytest.mark.slow

KNOWN = json.loads(fifty_digits.FILE.read_text())


@pytest.mark.parametrize("case", KNOWN)
def test_orbits_known_to_fifty_digits_lie_in_the_balls(case):
    orbit = fifty_digits.floating(case["machine"], case["word"], case["periods"], case["parameters"])
    proof = orbit.prove(**case["parameters"])
    assert proof.existence and proof.radius < 1e-20
    assert (proof.real, proof.stable) == (orbit.real, orbit.stable)
    with mp.workdps(60):
        for node, known in zip(proof.nodes(), case["nodes"], strict=True):
            assert all(holds(ball, number, "1e-48") for ball, number in zip(node, known, strict=True))


TILTED = Cavity(
    restitution_left=0.7, restitution_right=0.8, friction_left=0.4, friction_right=0.3, gravity=0.2,
    slope=0.1, distance_left=1.1, distance_right=0.9, mass_ratio=0.006, frequency=1.1,
)  # fmt: skip
HEAVY = Coupled(
    restitution=0.4, friction=0.7, gravity=0.3, mass_ratio=0.15, forcing=2.1, damping=0.8, excitation=0.6,
    slope=0.1, frequency=0.9,
)  # fmt: skip


@pytest.mark.parametrize(
    ("word", "half", "orbit"),
    [
        ("LR", True, lambda: Cavity(**STRONG).orbit("LR", amplitude=0.6)),
        ("LR", True, lambda: ABSORBER.changed(friction=0.0).symmetric_orbit(amplitude=0.7)),
        ("LR", True, lambda: COUPLED.changed(friction=0.0).symmetric_orbit(frequency=1.01)),
        ("LRs", False, lambda: ABSORBER.orbit("LRs", amplitude=1.0)),  # no machine follows it
        ("LttR", False, lambda: TILTED.attractor(amplitude=0.8).orbit),
        ("LtsRtt", False, lambda: HEAVY.attractor().orbit),
    ],
)
def test_proofs_say_what_floating_orbits_say(word, half, orbit):
    """Those are tested against integrations of the equations of motion; the checker verifies the inequalities by its own flights."""
    orbit = orbit()
    assert orbit.word.text == word
    proof = orbit.prove()
    assert proof.existence and proof.motif.half is half
    assert (proof.real, proof.stable) == (orbit.real, orbit.stable)
    middles = np.array([[float(middle) for middle, _ in node] for node in proof.nodes()])
    assert orbit.nodes == pytest.approx(middles, abs=1e-12)
    assert checked(proof)["claims"]["real"] is orbit.real
    assert orbit.real or proof.broken[0] in {"stick", "hold", "flight"}


@pytest.mark.parametrize("mode", [-1, 0, 1])
@pytest.mark.parametrize("machine", [TILTED, HEAVY])
def test_rates_of_flights_are_their_derivatives(machine, mode):
    """By the chain rule; bounds of the inequalities hang on them."""
    given_ = machine.named(machine.vector({"amplitude": 0.8} if machine is TILTED else {}))
    with precision(110):
        p = {name: ball(repr(value)) for name, value in given_.items()}
        node = [ball(text) for text in ("0.9", "0.25", "0.3", "-0.2")][: machine.node]
        flights = Flights(p, machine is HEAVY)
        motion = flights.launch("s" if mode == 0 else "L", mode, node)(Jet(ball("2.1"), {0: p["frequency"]}))
        pairs = [(partial(motion.v1, 0) + flights.bias, motion.push)]
        for names in (("w", "w1", "w2", "w3"), ("push", "push1", "push2"), ("v", "v1")):
            pairs += [(partial(getattr(motion, a), 0), getattr(motion, b)) for a, b in pairwise(names)]
    for found, expected in pairs:
        assert float(found) == pytest.approx(float(base(expected)), rel=1e-12)


# ------------------------------------------------------------------ verdicts
def test_on_the_border_neither_sign_is_proved():
    """At C = a exactly the stuck absorber is about to slip: in exact decimals, so no arithmetic can tell more."""
    values = {"restitution": "0.5", "friction": "0.5", "gravity": "0.25", "mass_ratio": "0", "frequency": "1"}
    proofs = {C: prove_stuck("absorber", values | {"amplitude": C}) for C in ("0.1249", "0.125", "0.1251")}
    assert [proof.real for proof in proofs.values()] == [True, None, False]
    assert proofs["0.125"].obstacles[0].remedy is Remedy.BORDER


def test_a_slip_cannot_wait():
    """Stuck for one forcing period more all equations hold as before, but the absorber has slipped long since.

    To the right friction is stronger than the shaking, so that the stuck absorber can slip to the left only.
    """
    machine = Cavity(
        restitution=0.95, friction_left=0.134, friction_right=0.6324, gravity=0.211, mass_ratio=0.006
    )
    nodes = np.array([[0.08468, 0.2993], [3.29124, 0.69934], [3.3577, 0.69934]])
    prompt = machine.orbit("Ls", 1, guess=nodes, amplitude=0.1326)
    assert prompt.residual < 1e-11 and prompt.real and prompt.replay() < 1e-9
    assert checked(prompt.prove())["claims"]["real"]
    late = Orbit(machine, prompt.word, 2, prompt.nodes + [[0, 0], [0, 0], [2.0 * np.pi, 0]], prompt.params)
    hold = next(margin for margin in late.margins if margin.kind == "hold")
    assert not late.real and hold.value == pytest.approx(-2.0 * np.pi, abs=1e-6)
    assert late.residual < 1e-11 and late.replay() > 0.1
    proof = late.prove()
    assert proof.existence and proof.real is False and proof.broken == ("hold", 1)
    certificate = checked(proof)
    certificate["claims"]["real"] = True
    with pytest.raises(Refused):
        check(certificate)


def test_parameters_may_be_balls():
    orbit = ABSORBER.symmetric_orbit(amplitude=0.6)
    proof = orbit.prove(amplitude=("0.6", "1e-6"), restitution=("0.76", "1e-7"))
    assert (proof.existence, proof.real, proof.stable) == (True, True, True)
    assert 1e-7 < proof.radius < 1e-4
    for shifted in (0.599999, 0.600001):  # the orbits of its ends lie inside
        other = ABSORBER.symmetric_orbit(amplitude=shifted)
        for node, balls in zip(other.nodes, proof.nodes()):
            assert all(holds(ball, x, "1e-14") for x, ball in zip(node, balls))
    checked(proof)


def test_a_failed_proof_says_which_step_and_what_would_help():
    orbit = ABSORBER.symmetric_orbit(amplitude=0.6)
    wide = orbit.prove(amplitude=("0.6", "0.3"))
    assert not wide.existence and "existence" in str(wide.obstacles[0])
    with pytest.raises(ValueError, match="nothing was proved"):
        wide.certificate()
    level = Cavity(**STRONG).orbit("LR", amplitude=0.6)
    assert not level.prove(slope="1e-9").motif.half  # no mirror image on a slope
    for given_, says in (
        ({"spin": "1"}, "no parameter"),
        ({"amplitude": "much"}, "finite"),
        ({"restitution": "1.5"}, "out of range"),
    ):
        with pytest.raises(ProofError, match=says):
            orbit.prove(**given_)


def test_words_to_64_impacts_with_work_that_grows_like_their_length():
    def calls(count):
        orbit, counted = ABSORBER.symmetric_orbit(amplitude=0.6).repeat(count // 2), Counter()
        sys.setprofile(lambda frame, event, argument: counted.update([event]))
        try:
            proof = orbit.prove(bits=640)
        finally:
            sys.setprofile(None)
        assert proof.existence and proof.real and proof.stable
        return counted["call"] + counted["c_call"]

    calls(2)  # imports
    short, long = calls(16), calls(64)
    assert 3.0 * short < long < 5.0 * short


# ------------------------------------------------------------------ wrong inputs
def drawn(count):
    """Random generators, so many of them."""
    seeds = st.integers(0, 2**32 - 1)
    return lambda test: settings(max_examples=count, deadline=None)(
        given(random=seeds.map(np.random.default_rng))(test)
    )


def one_of(things, random):
    return things[random.integers(len(things))]


@drawn(60)
def test_wrong_inputs_are_not_proved(random):
    orbit = one_of(tampering.orbits(), random)
    kind, wrong = tampering.wrong_input(tampering.arguments(orbit), random)
    assert not tampering.false_proof(wrong, orbit.symmetric and bool(random.integers(2))), kind


@drawn(30)
def test_wrong_special_points_are_not_proved(random):
    kind, wrong = tampering.wrong_point(one_of(tampering.points(), random), random)
    assert not tampering.false_point(wrong), kind


@drawn(12)
def test_wrong_certificates_are_refused(random):
    kind, wrong = tampering.wrong_certificate(one_of(tampering.certificates(), random), random)
    assert not tampering.verified(wrong), kind
