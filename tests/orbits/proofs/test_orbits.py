"""Proofs of orbits against orbits known to 50 digits by another route, against closed forms, and against wrong inputs."""

import json
import sys
from collections import Counter
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orbits import Absorber, Coupled
from orbits.proofs.checker import Refused, check
from orbits.proofs.obstacles import Obstacle, ProofError, Remedy
from orbits.proofs.subjects import of_orbit
from tools.proofs import fifty_digits, tampering

pytestmark = pytest.mark.slow

KNOWN = json.loads(fifty_digits.FILE.read_text())
ABSORBER = tampering.ABSORBER


def names(case):
    given = case["parameters"]
    friction = given.get("friction") or given["friction_left"]
    return f"{case['machine']}-{case['word']}-{given.get('amplitude') or given['frequency']}-{friction}"


def holds(pair, number):
    """Whether the decimal ball holds a number known to 50 digits."""
    with localcontext() as context:
        context.prec = 120
        middle, radius = (Decimal(text) for text in pair)
        return abs(Decimal(number) - middle) <= radius + Decimal("1e-48")


@pytest.mark.parametrize("case", KNOWN, ids=names)
def test_orbits_known_to_fifty_digits_lie_in_the_balls(case):
    orbit = fifty_digits.floating(case["machine"], case["word"], case["periods"], case["parameters"])
    proof = orbit.prove(**case["parameters"])
    assert proof.existence and proof.radius < 1e-20
    assert (proof.real, proof.stable) == (orbit.real, orbit.stable)
    for node, known in zip(proof.nodes(), case["nodes"], strict=True):
        assert all(holds(pair, number) for pair, number in zip(node, known, strict=True))


def test_the_symmetric_orbit_has_its_closed_form():
    """C sin Psi = 1 - pi beta/2 and C cos Psi = R beta + H, put into the balls at 40 digits."""
    from mpmath import mp, mpf, pi, sqrt

    proof = ABSORBER.symmetric_orbit(amplitude=0.6).prove()
    with mp.workdps(40):
        r, C = mpf("0.76"), mpf("0.6")
        R, H = (1 - r) / (1 + r), pi / 2 * mpf("1.006") * mpf("0.5") * mpf("0.211")
        # (1 - pi b/2)^2 + (R b + H)^2 = C^2, the larger root
        a2, a1, a0 = pi**2 / 4 + R**2, 2 * R * H - pi, 1 + H**2 - C**2
        beta = (-a1 + sqrt(a1**2 - 4 * a2 * a0)) / (2 * a2)
        B = beta + H  # pi a/2 at Omega = 1
        (_, (middle, radius)), *_ = proof.nodes()
        assert abs(mpf(middle) - B) < mpf(radius) + mpf(10) ** -38


# ------------------------------------------------------------------ verdicts
def test_an_orbit_that_no_machine_follows_is_proved_virtual():
    orbit = ABSORBER.orbit("LRs", 1, amplitude=1.0)
    proof = orbit.prove()
    assert proof.existence and proof.real is False and proof.broken[0] in {"stick", "hold", "flight"}
    assert min(m.value for m in orbit.margins) < 0


def test_on_the_border_neither_sign_is_proved():
    """At C = a exactly the stuck absorber is about to slip: in exact decimals, so no arithmetic can tell more."""
    machine = Absorber(restitution=0.5, friction=0.5, gravity=0.25, mass_ratio=0.0)
    from orbits.proofs.prove import prove_stuck

    values = {"restitution": "0.5", "friction": "0.5", "gravity": "0.25", "mass_ratio": "0", "frequency": "1"}
    assert machine.friction_acceleration(machine.vector({"amplitude": 0.125})) == 0.125
    proof = prove_stuck("absorber", values | {"amplitude": "0.125"})
    assert proof.real is None and proof.obstacles[0].remedy is Remedy.BORDER
    assert prove_stuck("absorber", values | {"amplitude": "0.1249"}).real is True
    assert prove_stuck("absorber", values | {"amplitude": "0.1251"}).real is False


def test_stability_on_either_side_of_the_symmetry_breaking():
    """0.5282903125... from the closed form (docs of the model): just below stable, just above unstable."""
    for square, stable in (("0.5282", True), ("0.5284", False)):
        amplitude = float(square) ** 0.5
        assert ABSORBER.symmetric_orbit(amplitude=amplitude).prove().stable is stable


def test_parameters_may_be_balls():
    orbit = ABSORBER.symmetric_orbit(amplitude=0.6)
    proof = orbit.prove(amplitude=("0.6", "1e-6"), restitution=("0.76", "1e-7"))
    assert (proof.existence, proof.real, proof.stable) == (True, True, True)
    assert 1e-7 < proof.radius < 1e-4
    for shifted in (0.599999, 0.600001):  # the orbits of its ends lie inside
        other = ABSORBER.symmetric_orbit(amplitude=shifted)
        for node, pairs in zip(other.nodes, proof.nodes()):
            assert all(abs(x - float(mid)) <= float(rad) + 1e-14 for x, (mid, rad) in zip(node, pairs))
    check(json.loads(json.dumps(proof.certificate())))


def test_a_failed_proof_says_which_step_and_what_would_help():
    orbit = ABSORBER.symmetric_orbit(amplitude=0.6)
    wide = orbit.prove(amplitude=("0.6", "0.3"))
    assert not wide.existence and isinstance(wide.obstacles[0], Obstacle)
    assert "existence" in str(wide.obstacles[0])
    with pytest.raises(ValueError, match="nothing was proved"):
        wide.certificate()
    with pytest.raises(ProofError, match="no parameter"):
        orbit.prove(spin="1")
    with pytest.raises(ProofError, match="finite"):
        orbit.prove(amplitude="much")
    with pytest.raises(ProofError, match="out of range"):
        orbit.prove(restitution="1.5")


# ------------------------------------------------------------------ long words
def repeated(count):
    return ABSORBER.symmetric_orbit(amplitude=0.6).repeat(count // 2)


def test_words_to_64_impacts_with_work_that_grows_like_their_length():
    def calls(count):
        orbit, counted = repeated(count), Counter()
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
@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_wrong_inputs_are_not_proved(seed):
    random = np.random.default_rng(seed)
    sound = tampering.orbits()
    orbit = sound[random.integers(len(sound))]
    kind, wrong = tampering.wrong_input(tampering.arguments(orbit), random)
    assert not tampering.false_proof(wrong, orbit.symmetric and bool(random.integers(2))), kind


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_wrong_special_points_are_not_proved(seed):
    random = np.random.default_rng(seed)
    found = tampering.points()
    kind, wrong = tampering.wrong_point(found[random.integers(len(found))], random)
    assert not tampering.false_point(wrong), kind


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_wrong_certificates_are_refused(seed):
    random = np.random.default_rng(seed)
    papers = tampering.certificates()
    kind, wrong = tampering.wrong_certificate(papers[random.integers(len(papers))], random)
    assert not tampering.verified(wrong), kind


@pytest.mark.parametrize(
    "junk", [{}, {"format": "contvines certificate 3"}, [], [[]], None, {"format": 1, "boxes": []}]
)
def test_junk_is_refused(junk):
    with pytest.raises(Refused):
        check(junk)


@pytest.mark.parametrize("half", [2, -1, 0.5, None, "yes"])
def test_half_a_word_is_closed_by_the_mirror_and_by_nothing_else(half):
    paper = json.loads(json.dumps(of_orbit(ABSORBER.symmetric_orbit(amplitude=0.6)).certificate()))
    check(paper)
    with pytest.raises(Refused):
        check(paper | {"half": half})


def test_without_the_library_a_sentence_says_so(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(ProofError, match="python-flint"):
        of_orbit(ABSORBER.symmetric_orbit(amplitude=0.6))


def test_without_friction_flights_may_reverse():
    machine = Absorber(restitution=0.8, friction=0.0, gravity=0.2, mass_ratio=0.0)
    proof = machine.symmetric_orbit(amplitude=0.7).prove()
    assert proof.motif.frictionless and proof.existence and proof.real
    check(json.loads(json.dumps(proof.certificate())))
    coupled = Coupled(
        restitution=0.76, friction=0.0, gravity=0.211, mass_ratio=0.006, forcing=2.47, damping=1.0
    ).symmetric_orbit(frequency=1.01)
    assert coupled.prove().real is coupled.real


def test_the_cavity_with_unlike_walls_and_a_slope():
    """Level and with equal sides it is the absorber, with the same nodes; else its own, against the floating orbit."""
    from orbits.attractors import find_attractor
    from orbits.machines.cavity import Cavity

    level = Cavity(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    same = level.orbit("LR", 1, guess=ABSORBER.symmetric_orbit(amplitude=0.6).nodes, amplitude=0.6).prove()
    for node, other in zip(
        same.nodes(), ABSORBER.symmetric_orbit(amplitude=0.6).prove().nodes(), strict=True
    ):
        for (a, r), (b, q) in zip(node, other, strict=True):
            assert abs(Decimal(a) - Decimal(b)) <= Decimal(r) + Decimal(q)
    machine = Cavity(
        restitution_left=0.7, restitution_right=0.8, friction_left=0.4, friction_right=0.3, gravity=0.2,
        slope=0.1, distance_left=1.1, distance_right=0.9, mass_ratio=0.006,
    )  # fmt: skip
    orbit = find_attractor(machine, amplitude=0.8).orbit
    proof = orbit.prove()
    assert (
        (proof.existence, proof.real, proof.stable) == (True, orbit.real, orbit.stable) == (True, True, True)
    )
    for node, pairs in zip(orbit.nodes, proof.nodes(), strict=True):
        assert all(abs(x - float(pair[0])) < 1e-8 for x, pair in zip(node, pairs, strict=True))
    check(json.loads(json.dumps(proof.certificate())))
