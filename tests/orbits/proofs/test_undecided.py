"""The checker's decisions are its own: intervals that overlap are distinguished by nobody, whatever mpmath makes of them."""

import json

import pytest
from mpmath import iv
from mpmath.ctx_iv import ivmpf
from sympy import Matrix, Rational

import contvines as cv
from orbits import Absorber
from orbits.proofs.checker import check, det, solved

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


def test_determinants_and_systems_are_those_of_exact_arithmetic():
    M = [[3, -1, 2, 5], [1, 4, 0, -2], [7, 1, -3, 1], [2, 2, 2, -1]]
    B = [[1, 0, 2, 0], [0, 1, 0, 3], [5, 0, 1, 0], [0, -1, 0, 1]]
    balls = [[[iv.mpf(entry) for entry in row] for row in rows] for rows in (M, B)]
    assert Rational(str(int(det(balls[0]).mid))) == Matrix(M).det()
    exact = Matrix(M).inv() * Matrix(B)
    found = solved(*balls)
    for i in range(4):
        for j in range(4):
            low, high = (iv.mpf(exact[i, j].p) / exact[i, j].q).a, (iv.mpf(exact[i, j].p) / exact[i, j].q).b
            assert found[i, j].a <= high and low <= found[i, j].b
