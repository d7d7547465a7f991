"""Special points: closed forms and brute-force roots inside the balls, borders from either side, pieces, the errata."""

import json
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf, pi, sqrt

import contvines as cv
from orbits import Cavity, Coupled
from orbits.proofs.checker import Refused, check
from orbits.proofs.obstacles import ProofError
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow

ERRATA = Path(__file__).parents[3] / "examples" / "certificates" / "errata.json"


@pytest.fixture(scope="module")
def graph():
    seed = ABSORBER.symmetric_orbit(amplitude=0.6)
    return cv.diagram(seed, over="amplitude", within=(0.24, 0.9), depth=1)


def value(proof):
    middle, radius = proof.value
    return mpf(middle), mpf(radius)


def verified(proof):
    check(json.loads(json.dumps(proof.certificate())))
    return True


def test_fold_and_symmetry_breaking_have_their_closed_forms(graph):
    with mp.workdps(45):
        r = mpf("0.76")
        R, H = (1 - r) / (1 + r), pi / 2 * mpf("1.006") * mpf("0.5") * mpf("0.211")
        for kind, below in (("fold", pi**2 + 4 * R**2), ("symmetry-breaking", pi**2 - 4)):
            beta = (2 * pi - 4 * R * H) / below
            expected = sqrt((1 - pi * beta / 2) ** 2 + (R * beta + H) ** 2)
            (point,) = (p for p in graph.of_kind(kind) if p.branch == "B1")
            proof = point.prove()
            middle, radius = value(proof)
            assert abs(middle - expected) < radius + mpf(10) ** -44
            assert proof.radius < 1e-20 and proof.transversal and proof.real is True
            assert verified(proof)


def test_every_special_point_of_the_graph_is_proved_and_verified(graph):
    proofs = graph.prove()
    assert set(proofs) == set(graph.special)
    for label, proof in proofs.items():
        assert proof.existence and proof.radius <= 1e-10, label
        assert proof.real is graph.special[label].real, label
        assert verified(proof), label
    assert "proved" in str(graph)
    assert graph.to_dict()["proofs"]["SB1"]["existence"] is True


def test_pure_sliding_begins_where_den_hartog_says():
    with mp.workdps(45):
        h = pi / 2 * mpf("1.006") * mpf("0.5") * mpf("0.211")
        expected = h * sqrt(1 + 4 / pi**2)
        orbit = ABSORBER.orbit("tt", 1, amplitude=float(expected))
        problem = orbit.problem("amplitude", symmetric=True)
        proof = problem.prove("stick", *orbit.seed(problem), margin=1)
        middle, radius = value(proof)
        assert abs(middle - expected) < radius + mpf(10) ** -44
    assert proof.real is True


def test_a_neimark_sacker_point_of_the_coupled_machine():
    machine = Coupled(
        restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, forcing=2.47, damping=1.0
    )
    orbit = machine.symmetric_orbit(frequency=1.02540971532)
    problem = orbit.problem("frequency", symmetric=True)
    proof = problem.prove("neimark-sacker", *orbit.seed(problem))
    assert proof.existence and proof.radius <= 1e-10 and proof.real is True
    assert verified(proof)
    middle, _ = value(proof)
    # the modulus of the pair changes sides there
    sizes = [
        max(abs(machine.symmetric_orbit(frequency=float(middle) + side).half_multipliers))
        for side in (-1e-6, 1e-6)
    ]
    assert min(sizes) < 1.0 < max(sizes)


def test_the_bouncing_ball_doubles_where_its_closed_form_says():
    """One bounce per period: a fold at A = pi (1 - r)/(1 + r), a doubling at A^2 = A_fold^2 + (2 (1 + r^2)/(1 + r)^2)^2 (g = 1)."""
    machine = Cavity(
        restitution=0.8,
        friction=0.0,
        gravity=1.0,
        slope=float(np.pi / 2),
        distance_left=1000.0,
        mass_ratio=0.0,
    )
    r = mpf("0.8")
    with mp.workdps(30):
        square = (mp.pi * (1 - r) / (1 + r)) ** 2 + (2 * (1 + r**2) / (1 + r) ** 2) ** 2
        orbit = machine.orbit("R", 1, amplitude=float(mp.sqrt(square)))
        problem = orbit.problem("amplitude", symmetric=False)
        proof = problem.prove("period-doubling", *orbit.seed(problem))
        # the slope is the decimal next to pi/2, 6e-17 from it
        assert proof.existence and proof.real and abs(value(proof)[0] - mp.sqrt(square)) < mpf("1e-15")
    assert verified(proof)


def test_an_ordinary_orbit_is_no_special_point(graph):
    branch = graph["B1"]
    i = int(np.argmin(np.abs(branch.values - 0.6)))
    for kind in ("fold", "symmetry-breaking"):
        proof = branch.problem.prove(kind, branch.points[i], float(branch.values[i]))
        assert not proof.existence and proof.obstacles
    with pytest.raises(ProofError, match="margin"):
        branch.problem.prove("stick", branch.points[i], float(branch.values[i]))


def test_an_inequality_is_left_out_only_at_its_border():
    """To name a margin does not excuse an orbit from it."""
    virtual = ABSORBER.orbit("tt", 1, amplitude=0.18).prove()
    wrong = json.loads(json.dumps(virtual.certificate()))
    check(wrong)
    wrong["claims"]["real"] = True
    for i in range(len(wrong["events"])):
        for side in (1, -1):
            wrong["boxes"][0]["conditions"] = [["flight", i, side]]
            for kind in (None, "border"):
                wrong["boxes"][0]["kind"] = kind
                with pytest.raises(Refused):
                    check(wrong)


def test_a_stretch_goes_up_to_its_special_points(graph):
    """From the symmetry breaking on the branch is unstable, up to the point itself; the certificate begins with the point's."""
    breaking = next(p for p in graph.of_kind("symmetry-breaking") if p.branch == "B1")
    proof = graph.prove("B1", within=(breaking.value - 1e-9, breaking.value + 1e-3))["B1"]
    piece = next(p for p in proof.pieces if "symmetry-breaking" in p.ends and p.stable is False)
    assert piece.existence and piece.real is True and piece.ends == ("symmetry-breaking", None)
    with mp.workdps(45):
        assert 0 < mpf(piece.covered[0]) - value(breaking.prove())[0] < mpf("1e-10")
    short = json.loads(json.dumps(piece.certificate()))
    short["boxes"] = short["boxes"][:7]
    check(short)
    assert short["boxes"][1]["kind"] == "symmetry-breaking"
    short["claims"]["stable"] = True
    with pytest.raises(Refused):
        check(short)


# ------------------------------------------------------------------ the errata
def test_the_certificates_of_the_errata():
    made = json.loads(ERRATA.read_text())
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
    for certificate in made.values():
        check(certificate)
    square = {
        name: mpf(c["boxes"][1]["parameter"][0]) ** 2 for name, c in made.items() if len(c["boxes"]) == 3
    }
    assert abs(square["doubling of the printed maps"] - mpf("0.86787")) < 5e-6
    assert abs(square["doubling of the machine"] - mpf("1.128")) < 5e-4
