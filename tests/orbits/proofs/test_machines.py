"""Proofs of machines in physical units, of level cavities by their mirror image, and what the checker may cost."""

import ast
import json
from pathlib import Path

import pytest
from mpmath import iv, mp, mpf

from orbits import Absorber, Cavity
from orbits.proofs import checker
from orbits.proofs.balls import ball, precision
from orbits.proofs.jets import Jet, power
from orbits.proofs.obstacles import ProofError

pytestmark = pytest.mark.slow

STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}


def verified(proof):
    checker.check(json.loads(json.dumps(proof.certificate())))
    return True


def test_a_slope_has_no_half_words():
    level = Cavity(**STRONG)
    orbit = level.orbit("LR", 1, guess=Absorber(**STRONG).symmetric_orbit(amplitude=0.6).nodes, amplitude=0.6)
    assert not orbit.prove(slope="1e-9").motif.half
    with pytest.raises(ProofError, match="no parameter"):
        orbit.prove(incline="0")


@pytest.mark.parametrize("exponent", [-2, -1, 0.5, 1, 2, 3])
def test_powers_of_a_parameter(exponent):
    """Value and derivative against mpmath's."""
    with precision(160), mp.workdps(40):
        found = power(Jet(ball("1.7"), {0: ball("1")}), exponent)
        x = mpf("1.7")
        for part, expected in (
            (found.value, x**exponent),
            (found.partials[0], exponent * x ** (exponent - 1)),
        ):
            middle = mpf(part.mid().str(40, radius=False))
            assert abs(middle - expected) < mpf(10) ** -36


# ------------------------------------------------------------------ the checker
def test_the_checker_is_short_and_stands_alone():
    path = Path(checker.__file__)
    lines = path.read_text().splitlines()
    assert len(lines) <= 200 and max(len(line) for line in lines) <= 126
    imported = {
        alias.name.split(".")[0]
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in (node.names if isinstance(node, ast.Import) else [ast.alias(node.module or "")])
    }
    assert imported == {"re", "typing", "mpmath", "numpy"}


def test_the_checkers_flights_solve_the_equations_of_motion():
    """w'' = -C Omega^2 sin(Psi) - s a of the shaken absorber, and both masses of the coupled machine, at random instants."""
    entries = {
        "restitution": "0.7",
        "friction": "0.4",
        "gravity": "0.3",
        "mass_ratio": "0.02",
        "frequency": "1.1",
    }
    iv.prec, phase = 160, iv.mpf("1.9")
    eps, om, drag, force = (iv.mpf(text) for text in ("0.02", "1.1", "0.8", "2.5"))
    a = (1 + eps) * iv.mpf("0.4") * iv.mpf("0.3")
    node = [checker.jet(iv.mpf(text)) for text in ("0.3", "0.5", "0.2", "-0.4")]

    def flight(own, mode, letter="t"):
        given = {name: [text, "0", "0"] for name, text in {**entries, **own}.items()}
        p = checker.machine({"parameters": given}, checker.jet(1))
        n = 4 if "forcing" in own else 2
        return [
            [a[0] for a in rates] for rates in checker.motion(p, letter, mode, node[:n], checker.jet(phase))
        ]

    for mode in (1, -1, 0):
        q, w = flight({"forcing": "2.5", "damping": "0.8", "excitation": "1"}, mode, "t" if mode else "s")
        pull, mass = mode * a / (1 + eps), 1 if mode else 1 + eps
        # e = eps G sin Psi; q1'' (m q1'' while stuck) + eps lambda q1' + q1 = e + eps lambda e' - eps mu g s, q2'' = mu g s
        for k in range(3):  # and the same differentiated in time
            turned = [
                (iv.sin, iv.cos),
                (iv.cos, lambda x: -iv.sin(x)),
                (lambda x: -iv.sin(x), lambda x: -iv.cos(x)),
            ]
            sine, cosine = (function(phase) * om**k for function in turned[k])
            push = eps * force * (sine + eps * drag * om * cosine) - (eps * pull if k == 0 else 0)
            assert abs(float((mass * q[k + 2] - push + eps * drag * q[k + 1] + q[k]).mid)) < 1e-30
        second = q[2] - pull if mode else iv.mpf(0)
        assert abs(float((w[2] - second).mid)) < 1e-30 and w[3] - (q[3] if mode else 0) in iv.mpf(
            [-1e-30, 1e-30]
        )
        q, w = flight({"amplitude": "2.5"}, mode, "t" if mode else "s")
        shake = -force * om**2 * iv.sin(phase)
        assert abs(float((w[2] - (shake - mode * a if mode else 0)).mid)) < 1e-30
        assert abs(float((q[2] - shake).mid)) < 1e-30


def test_decimals_only():
    for text in ("nan", "inf", "1e", "0x1", " 1", "1_0", ""):
        with pytest.raises(checker.Refused):
            checker.number(text)
    tenth = checker.number("0.1")
    assert tenth * 10 - 1 in iv.mpf([-1, 1]) * iv.mpf("1e-30")


def test_the_stuck_absorber_is_inside_the_cavity_and_stable_by_damping_alone():
    """Without the absorber's mass nothing damps the oscillator (its drag is mass ratio times damping); beyond a wall nobody sticks."""
    from orbits.proofs.prove import prove_stuck

    given = {
        "forcing": "0.1", "damping": "1", "excitation": "1", "restitution": "0.7", "friction": "0.5",
        "gravity": "0.3", "mass_ratio": "0.01", "frequency": "0.5",
    }  # fmt: skip
    proof = prove_stuck("coupled", given)
    assert proof.real and proof.stable and verified(proof)
    sound = json.loads(json.dumps(proof.certificate()))
    for change in (
        lambda c: c["parameters"].__setitem__("mass_ratio", ["0", "0", "0"]),
        lambda c: c["parameters"].__setitem__("damping", ["0", "0", "0"]),
        lambda c: c["boxes"][0]["nodes"][0][1].__setitem__(0, "1.5"),
    ):
        wrong = json.loads(json.dumps(sound))
        change(wrong)
        with pytest.raises(checker.Refused):
            checker.check(wrong)
