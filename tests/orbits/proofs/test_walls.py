"""Borders at walls: closed forms inside the balls, and certificates that a checker accepts."""

import json

import numpy as np
import pytest
from mpmath import cos, findroot, mp, mpf, pi, sin, sqrt

from orbits import Absorber, Cavity
from orbits.proofs.checker import Refused, check

pytestmark = pytest.mark.slow


def verified(proof):
    certificate = json.loads(json.dumps(proof.certificate()))
    check(certificate)
    certificate["claims"]["real"] = False
    with pytest.raises(Refused):
        check(certificate)
    return True


def test_pure_sliding_ends_at_the_walls():
    """It turns at w = -+ sqrt(C^2 - h^2)."""
    with mp.workdps(45):
        h = pi / 2 * mpf("1.006") * mpf("0.2") * mpf("0.211")
        expected = sqrt(1 + h * h)
        machine = Absorber(restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006)
        orbit = machine.orbit("tt", 1, amplitude=float(expected))
        problem = orbit.problem("amplitude", symmetric=True)
        proof = problem.prove("wall-graze", *orbit.seed(problem), margin=2)
        middle, radius = (mpf(x) for x in proof.value)
        assert abs(middle - expected) < radius + mpf(10) ** -44
    assert proof.real is True and verified(proof)


def test_a_bouncing_ball_reaches_the_other_wall():
    """Without friction the ball neither knows the left wall nor touches it, until the wall stands where it turns back."""
    given = {
        "restitution": 0.6,
        "friction": 0.0,
        "gravity": 0.7,
        "slope": 0.9,
        "mass_ratio": 0.05,
        "distance_right": 0.8,
    }
    with mp.workdps(45):
        b = mpf("1.05") * mpf("0.7") * sin(mpf("0.9"))
        C = mpf("1.3")
        speed = b * pi  # w'+ - v' = -B+, and B+ = -pi b over one period
        psi = -mp.acos(-mpf("0.4") / mpf("1.6") * pi * b / C)

        def rate(x):
            return C * cos(x) + speed - b * (x - psi)

        top = findroot(rate, psi + speed / b)
        height = -mpf("0.8") + C * (sin(top) - sin(psi)) + speed * (top - psi) - b * (top - psi) ** 2 / 2
        machine = Cavity(**given, distance_left=float(height))
        orbit = machine.orbit("R", 1, amplitude=1.3)
        phase = (orbit.nodes[0, 0] - float(psi)) % (2.0 * np.pi)
        assert min(phase, 2.0 * np.pi - phase) < 1e-9
        problem = orbit.problem("distance_left")
        assert abs(orbit.margins[0].value) < 1e-9
        proof = problem.prove("wall-graze", *orbit.seed(problem), margin=0)
        middle, radius = (mpf(x) for x in proof.value)
        assert abs(middle - height) < radius + mpf(10) ** -40
    assert proof.real is True and verified(proof)
