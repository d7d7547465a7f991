"""The checker's decisions are its own: intervals that overlap are distinguished by nobody, whatever mpmath makes of them."""

import json

import pytest
from mpmath.ctx_iv import ivmpf

import contvines as cv
from orbits import Absorber
from orbits.proofs.checker import check

pytestmark = pytest.mark.slow


@pytest.fixture
def strict(monkeypatch):
    """Comparisons of overlapping intervals fail, as they do from mpmath 1.4 on; before, they were None."""
    original = ivmpf._compare

    def decided(one, other, comparison):
        found = original(one, other, comparison)
        if found is None:
            raise ValueError("these intervals overlap")
        return found

    monkeypatch.setattr(ivmpf, "_compare", decided)


def test_a_stretch_through_a_fold_and_a_symmetry_breaking_is_verified(strict):
    machine = Absorber(restitution=0.7, friction=0.3, gravity=0.3, mass_ratio=0.02)
    graph = cv.diagram(machine.symmetric_orbit(amplitude=0.6), over="amplitude", within=(0.25, 0.76), depth=0)
    assert {"LP1", "SB1"} <= set(graph.special)
    for label in ("LP1", "SB1"):
        check(json.loads(json.dumps(graph[label].prove().certificate())))
    certificate = graph["B1"].prove(within=(0.7327, 0.7328)).certificate()
    check(json.loads(json.dumps(certificate)))
