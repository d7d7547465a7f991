"""The checker of certificates: what it may cost, what it refuses, what is kept of the errata."""

import ast
import json
from pathlib import Path

import pytest
from mpmath import mpf

from orbits.proofs import checker
from orbits.proofs.checker import Refused, check
from orbits.proofs.prove import prove_stuck
from tests.machines import ABSORBER
from tests.orbits.proofs.papers import checked

pytestmark = pytest.mark.slow

ERRATA = Path(__file__).parents[3] / "examples" / "certificates" / "errata.json"


def test_the_checker_is_short_and_stands_alone():
    text = Path(checker.__file__).read_text()
    lines = text.splitlines()
    assert len(lines) <= 200 and max(map(len, lines)) <= 126
    imported = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            imported.add(node.module)
        elif isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
    assert imported == {"re", "typing", "mpmath", "numpy"}


def test_junk_is_refused_and_half_a_word_that_nothing_closes():
    sound = checked(ABSORBER.symmetric_orbit(amplitude=0.6).prove())
    assert sound["half"]
    halves = [sound | {"half": half} for half in (2, -1, 0.5, None, "yes")]
    for junk in ({}, {"format": sound["format"]}, [], [[]], None, {"format": 1, "boxes": []}, *halves):
        with pytest.raises(Refused):
            check(junk)
    for text in ("nan", "inf", "1e", "0x1", " 1", "1_0", ""):
        with pytest.raises(Refused):
            checker.number(text)


def test_the_stuck_absorber_is_inside_the_cavity_and_stable_by_damping_alone():
    """Without the absorber's mass nothing damps the oscillator (its drag is mass ratio times damping); beyond a wall nobody sticks."""
    given = {
        "forcing": "0.1", "damping": "1", "excitation": "1", "restitution": "0.7", "friction": "0.5",
        "gravity": "0.3", "mass_ratio": "0.01", "frequency": "0.5",
    }  # fmt: skip
    proof = prove_stuck("coupled", given)
    assert proof.real and proof.stable
    for where in ("mass_ratio", "damping", "place"):
        wrong = checked(proof)
        if where == "place":
            wrong["boxes"][0]["nodes"][0][1][0] = "1.5"
        else:
            wrong["parameters"][where][0] = "0"
        with pytest.raises(Refused):
            check(wrong)


def test_the_certificates_of_the_errata():
    made = json.loads(ERRATA.read_text())
    check(list(made.values()))
    claims = {name: (c["claims"]["real"], c["claims"]["stable"]) for name, c in made.items()}
    assert claims == {
        "doubling of the printed maps": (False, None),
        "doubling of the machine": (True, None),
        "pure sliding begins": (True, None),
        "sliding above the printed bound": (False, True),
        "stick-slip above the printed bound": (True, True),
        "two periods at 0.986": (False, True),
        "one period at 0.986": (True, True),
    }
    for name, square, digits in (("printed maps", "0.86787", 5e-6), ("machine", "1.128", 5e-4)):
        box = made[f"doubling of the {name}"]["boxes"][1]
        assert abs(mpf(box["parameter"][0]) ** 2 - mpf(square)) < digits
