"""Special points: closed forms and brute-force roots inside the balls, borders from either side, pieces."""

import json

import numpy as np
import pytest
from mpmath import cos, findroot, mp, mpf, pi, sin, sqrt

from orbits import Cavity
from orbits.proofs.checker import Refused, check
from orbits.proofs.obstacles import ProofError
from tests.machines import ABSORBER, COUPLED, absorber_graph
from tests.orbits.proofs.papers import checked, holds

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.6, (0.24, 0.9), depth=1)


def proof_of(kind, orbit, parameter="amplitude", **options):
    """The proof of a special point at an orbit beside it."""
    problem = orbit.problem(parameter)
    proof = problem.prove(kind, *orbit.seed(problem), **options)
    assert proof.existence and proof.real is True and checked(proof)
    return proof


def test_fold_and_symmetry_breaking_have_their_closed_forms(graph):
    with mp.workdps(45):
        r = mpf("0.76")
        R, H = (1 - r) / (1 + r), pi / 2 * mpf("1.006") * mpf("0.5") * mpf("0.211")
        for kind, below in (("fold", pi**2 + 4 * R**2), ("symmetry-breaking", pi**2 - 4)):
            beta = (2 * pi - 4 * R * H) / below
            (point,) = (p for p in graph.of_kind(kind) if p.branch == "B1")
            proof = point.prove()
            assert holds(proof.value, sqrt((1 - pi * beta / 2) ** 2 + (R * beta + H) ** 2))
            assert proof.radius < 1e-20 and proof.transversal


def test_every_special_point_of_the_graph_is_proved_and_verified(graph):
    proofs = graph.prove()
    assert set(proofs) == set(graph.special)
    for label, proof in proofs.items():
        assert proof.existence and proof.radius <= 1e-10, label
        assert proof.real is graph.special[label].real, label
        checked(proof)
    assert "proved" in str(graph)
    assert graph.to_dict()["proofs"]["SB1"]["existence"] is True


@pytest.mark.parametrize(
    ("kind", "margin", "friction", "amplitude"),
    [
        ("stick", 1, "0.5", lambda h: h * sqrt(1 + 4 / pi**2)),
        ("wall-graze", 2, "0.2", lambda h: sqrt(1 + h * h)),
    ],
)
def test_pure_sliding_begins_where_den_hartog_says_and_ends_at_the_walls(kind, margin, friction, amplitude):
    """It turns at w = -+ sqrt(C^2 - h^2)."""
    with mp.workdps(45):
        expected = amplitude(pi / 2 * mpf("1.006") * mpf(friction) * mpf("0.211"))
        orbit = ABSORBER.changed(friction=float(friction)).orbit("tt", amplitude=float(expected))
        assert holds(proof_of(kind, orbit, margin=margin).value, expected)


def test_a_neimark_sacker_point_of_the_coupled_machine():
    proof = proof_of("neimark-sacker", COUPLED.symmetric_orbit(frequency=1.02540971532), "frequency")
    assert proof.radius <= 1e-10
    beside = [COUPLED.symmetric_orbit(frequency=float(proof.value[0]) + side) for side in (-1e-6, 1e-6)]
    sizes = [abs(orbit.half_multipliers).max() for orbit in beside]
    assert min(sizes) < 1.0 < max(sizes)  # the modulus of the pair changes sides there


def test_the_bouncing_ball_doubles_where_its_closed_form_says():
    """One bounce per period: a fold at A = pi (1 - r)/(1 + r), a doubling at A^2 = A_fold^2 + (2 (1 + r^2)/(1 + r)^2)^2 (g = 1)."""
    machine = Cavity(
        restitution=0.8, friction=0.0, gravity=1.0, slope=float(np.pi / 2), distance_left=1000.0, mass_ratio=0.0
    )  # fmt: skip
    r = mpf("0.8")
    with mp.workdps(30):
        expected = sqrt((pi * (1 - r) / (1 + r)) ** 2 + (2 * (1 + r**2) / (1 + r) ** 2) ** 2)
        proof = proof_of("period-doubling", machine.orbit("R", amplitude=float(expected)))
        assert holds(proof.value, expected, "1e-15")  # the slope is the decimal next to pi/2, 6e-17 from it


def test_a_bouncing_ball_reaches_the_other_wall():
    """Without friction the ball neither knows the left wall nor touches it, until the wall stands where it turns back."""
    with mp.workdps(45):
        b = mpf("1.05") * mpf("0.7") * sin(mpf("0.9"))
        C = mpf("1.3")
        speed = b * pi  # w'+ - v' = -B+, and B+ = -pi b over one period
        psi = -mp.acos(-mpf("0.4") / mpf("1.6") * pi * b / C)
        top = findroot(lambda x: C * cos(x) + speed - b * (x - psi), psi + speed / b)
        height = -mpf("0.8") + C * (sin(top) - sin(psi)) + speed * (top - psi) - b * (top - psi) ** 2 / 2
        machine = Cavity(
            restitution=0.6, friction=0.0, gravity=0.7, slope=0.9, mass_ratio=0.05, distance_right=0.8,
            distance_left=float(height),
        )  # fmt: skip
        orbit = machine.orbit("R", 1, amplitude=1.3)
        assert np.exp(1j * orbit.nodes[0, 0]) == pytest.approx(np.exp(1j * float(psi)), abs=1e-9)
        assert abs(orbit.margins[0].value) < 1e-9
        assert holds(proof_of("wall-graze", orbit, "distance_left", margin=0).value, height, "1e-40")


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
    wrong = checked(ABSORBER.orbit("tt", 1, amplitude=0.18).prove())
    wrong["claims"]["real"] = True
    (box,) = wrong["boxes"]
    for i in range(len(wrong["events"])):
        for side in (1, -1):
            for kind in (None, "border"):
                box |= {"kind": kind, "conditions": [["flight", i, side]]}
                with pytest.raises(Refused):
                    check(wrong)


def test_a_stretch_goes_up_to_its_special_points(graph):
    """From the symmetry breaking on the branch is unstable, up to the point itself; the certificate begins with the point's."""
    breaking = next(p for p in graph.of_kind("symmetry-breaking") if p.branch == "B1")
    proof = graph.prove("B1", within=(breaking.value - 1e-9, breaking.value + 1e-3))["B1"]
    piece = next(p for p in proof.pieces if "symmetry-breaking" in p.ends and p.stable is False)
    assert piece.existence and piece.real is True and piece.ends == ("symmetry-breaking", None)
    with mp.workdps(45):
        assert 0 < mpf(piece.covered[0]) - mpf(breaking.prove().value[0]) < mpf("1e-10")
    short = json.loads(json.dumps(piece.certificate()))
    short["boxes"] = short["boxes"][:7]
    check(short)
    assert short["boxes"][1]["kind"] == "symmetry-breaking"
    short["claims"]["stable"] = True
    with pytest.raises(Refused):
        check(short)
    assert all(checked(graph["B1"].prove(within=(breaking.value - 1e-5, breaking.value + 1e-4))))
