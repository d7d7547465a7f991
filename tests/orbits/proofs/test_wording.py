"""Proofs speak of a motion by the word that tables and pictures have for it."""

import pytest

pytest.importorskip("flint")

from orbits import Absorber
from orbits.proofs.wording import spelling

ABSORBER = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)


@pytest.mark.parametrize(("word", "amplitude"), [("RLtL", 1.16), ("LRtR", 1.16), ("ttLR", 0.95)])
def test_an_orbit_begun_anywhere_has_the_orbits_own_spelling(word, amplitude):
    orbit = ABSORBER.orbit(word, amplitude=amplitude)
    proof = orbit.prove()
    assert spelling(proof) == orbit.spelling in ("LRLt", "LRtt")
    assert f"the orbit of {orbit.spelling}: exists" in str(proof)


def test_half_an_orbit_stands_for_the_whole():
    orbit = ABSORBER.orbit("LR", amplitude=0.5)
    assert str(orbit.prove()).startswith("the orbit of symmetric LR: exists")
