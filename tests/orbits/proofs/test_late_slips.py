"""A slip cannot wait: where friction gives way and the word slips a forcing period later, no machine follows."""

import json

import numpy as np
import pytest

from orbits import Cavity
from orbits.orbit import Orbit
from orbits.proofs.checker import Refused, check
from orbits.proofs.subjects import of_orbit

pytestmark = pytest.mark.slow

# to the right friction is stronger than the shaking: the stuck absorber can slip to the left only
MACHINE = Cavity(
    restitution=0.95, friction_left=0.134, friction_right=0.6324, gravity=0.211, mass_ratio=0.006
)
AMPLITUDE = 0.1326
NODES = [[0.08468, 0.2993], [3.29124, 0.69934], [3.3577, 0.69934]]


@pytest.fixture(scope="module")
def prompt():
    return MACHINE.orbit("Ls", 1, guess=NODES, amplitude=AMPLITUDE)


@pytest.fixture(scope="module")
def late(prompt):
    """Stuck for one forcing period more: all equations hold as before."""
    nodes = prompt.nodes.copy()
    nodes[2, 0] += 2.0 * np.pi
    return Orbit(MACHINE, prompt.word, 2, nodes, prompt.params)


def test_in_numbers(prompt, late):
    assert prompt.residual < 1e-11 and prompt.real and prompt.replay() < 1e-9
    assert late.residual < 1e-11
    hold = next(margin for margin in late.margins if margin.kind == "hold")
    assert not late.real and hold.value == pytest.approx(-2.0 * np.pi, abs=1e-6)
    assert late.replay() > 0.1  # the simulated absorber has slipped long since


def test_in_proofs(prompt, late):
    proof = of_orbit(prompt)
    assert proof.existence and proof.real is True
    check(json.loads(json.dumps(proof.certificate())))
    proof = of_orbit(late)
    assert proof.existence and proof.real is False and proof.broken == ("hold", 1)
    certificate = json.loads(json.dumps(proof.certificate()))
    check(certificate)
    certificate["claims"]["real"] = True
    with pytest.raises(Refused):
        check(certificate)
