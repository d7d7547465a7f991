"""Responses to compare with: against linear algebra, Den Hartog's closed forms, and the balance of the first harmonics."""

import math

import numpy as np
import pytest

from orbits.design.references import bare, fixed_points, friction_damper, tuned, tuning


@pytest.mark.parametrize("eps", [0.0084, 0.05, 0.2])
def test_the_tuned_absorber_is_den_hartog_s(eps):
    """At two fixed points the response to a force is sqrt(1 + 2/mu), whatever the damping.

    Its peak exceeds that by little, and no other tuning nearby has a lower one by more.
    """
    forcing, height = 1.0 / eps, math.sqrt(1.0 + 2.0 / eps)
    f, zeta = tuning(eps)
    for omega in fixed_points(eps):
        for damping in (0.01, zeta, 0.6):
            found = tuned(omega, forcing, 0.0, eps, 0.0, (1.0 / (1.0 + eps), damping))
            assert float(found) == pytest.approx(height, rel=1e-11)
    omega = np.linspace(0.7, 1.3, 4001)

    def top(df, dz):
        return float(tuned(omega, forcing, 0.0, eps, 0.0, (f * df, zeta * dz)).max())

    assert height <= top(1.0, 1.0) < 1.005 * height
    for other in ((1.02, 1.0), (0.98, 1.0), (1.0, 1.3), (1.0, 0.7)):
        assert top(*other) > top(1.0, 1.0)


def test_the_bare_and_the_tuned_oscillator_solve_their_equations():
    eps, lam, G, omega, chi = 0.02, 1.5, 2.0, 0.97, 1.0
    f, zeta = tuning(eps)
    c, k = 2.0 * eps * zeta, eps * f * f
    both = np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = np.diag([1.0, 0.0]) + k * both + 1j * omega * (np.diag([eps * lam, 0.0]) + c * both)
    base = eps * G * (1.0 + 1j * chi * eps * lam * omega)
    x = np.linalg.solve(stiffness - omega**2 * np.diag([1.0, eps]), [base, 0.0])
    assert float(tuned(omega, G, lam, eps, chi)) == pytest.approx(abs(x[0]), rel=1e-12)
    one = base / (1.0 - omega**2 + 1j * omega * eps * lam)
    assert float(bare(omega, G, lam, eps, chi)) == pytest.approx(abs(one), rel=1e-12)


@pytest.mark.parametrize("chi", [0.0, 1.0])
@pytest.mark.parametrize("frequency", [0.9, 1.0, 1.1])
def test_the_first_harmonic_of_a_sliding_mass_is_in_balance(frequency, chi):
    """Both equations of motion, written as complex numbers with the relative displacement z = -|z| real.

    Absorber: Omega^2 (q + z) = own i z/|z|, so that |q|^2 = |z|^2 + (own/Omega^2)^2; oscillator:
    (1 - Omega^2 + i eps lambda Omega) q - eps own i z/|z| is the force. Where friction holds, both masses are one.
    """
    G, lam, eps, pull = 3.0, 0.5, 0.05, 0.3
    drag = 1j * eps * lam * frequency
    expected = eps * G * abs(1.0 + chi * drag)
    q = float(friction_damper(frequency, G, lam, eps, pull, chi))
    own = 4.0 / math.pi * pull  # of a square wave
    z = math.sqrt(q**2 - (own / frequency**2) ** 2)
    moved = -z + 1j * own / frequency**2
    force = (1.0 - frequency**2 + drag) * moved - 1j * eps * own
    assert z > 0.0 and abs(force) == pytest.approx(expected, rel=1e-9)
    held = float(friction_damper(frequency, G, lam, eps, 1e3, chi))
    assert held == pytest.approx(expected / abs(1.0 - (1.0 + eps) * frequency**2 + drag), rel=1e-12)
