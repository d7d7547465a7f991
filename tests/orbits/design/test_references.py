"""Responses to compare with: against linear algebra, Den Hartog's closed forms, and a simulation of sliding friction."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbits.design.references import bare, fixed_points, friction_damper, tuned, tuning


@pytest.mark.parametrize("eps", [0.0084, 0.05, 0.2])
def test_den_hartog_s_fixed_points(eps):
    """At the two fixed points the response is sqrt(1 + 2/mu), whatever the damping."""
    forcing = 1.0 / eps  # a unit force
    for omega in fixed_points(eps):
        for zeta in (0.01, tuning(eps)[1], 0.6):
            height = float(tuned(omega, forcing, 0.0, eps, 0.0, (1.0 / (1.0 + eps), zeta)))
            assert height == pytest.approx(math.sqrt(1.0 + 2.0 / eps), rel=1e-11)


@pytest.mark.parametrize("eps", [0.01, 0.05])
def test_the_tuned_absorber_is_the_best_of_its_mass(eps):
    """Its peak exceeds the fixed points' height by little, and no other tuning nearby has a lower one by more than that."""
    omega = np.linspace(0.7, 1.3, 4001)
    height = math.sqrt(1.0 + 2.0 / eps)

    def top(f, zeta):
        return float(tuned(omega, 1.0 / eps, 0.0, eps, 0.0, (f, zeta)).max())

    f, zeta = tuning(eps)
    assert height <= top(f, zeta) < 1.005 * height
    for df, dz in ((1.02, 1.0), (0.98, 1.0), (1.0, 1.3), (1.0, 0.7)):
        assert top(f * df, zeta * dz) > top(f, zeta)


def test_the_bare_and_the_tuned_oscillator_solve_their_equations():
    eps, lam, G, omega, chi = 0.02, 1.5, 2.0, 0.97, 1.0
    f, zeta = tuning(eps)
    c, k = 2.0 * eps * zeta, eps * f * f
    M = np.diag([1.0, eps])
    K = np.array([[1.0 + k, -k], [-k, k]])
    D = np.array([[eps * lam + c, -c], [-c, c]])
    base = eps * G * (1.0 + 1j * chi * eps * lam * omega)
    x = np.linalg.solve(K - omega**2 * M + 1j * omega * D, [base, 0.0])
    assert float(tuned(omega, G, lam, eps, chi)) == pytest.approx(abs(x[0]), rel=1e-12)
    one = base / (1.0 - omega**2 + 1j * omega * eps * lam)
    assert float(bare(omega, G, lam, eps, chi)) == pytest.approx(abs(one), rel=1e-12)


def test_the_friction_damper_against_a_simulation():
    """Friction smoothed over a narrow range of speeds, integrated until it is steady; the first harmonic is a good part of it."""
    eps, lam, G, omega, pull = 0.05, 0.4, 1.0, 0.98, 0.05

    def rates(t, y):
        q1, v1, v2 = y
        S = math.tanh((v1 - v2) / 2e-4)
        e, er = eps * G * math.sin(omega * t), eps * G * omega * math.cos(omega * t)
        return v1, e + eps * lam * er - eps * lam * v1 - q1 - eps * pull * S, pull * S

    end = 2.0 * np.pi / omega * 150
    steady = solve_ivp(
        rates, (0.0, end), [0.0, 0.0, 0.0], method="LSODA", rtol=1e-6, atol=1e-9, max_step=0.05
    )
    last = steady.t > end - 4.0 * np.pi / omega
    seen = np.abs(steady.y[0][last]).max()
    found = float(friction_damper(omega, G, lam, eps, pull))
    assert found == pytest.approx(seen, rel=0.01)
    assert found < float(bare(omega, G, lam, eps))


@pytest.mark.parametrize("frequency", [0.9, 1.0, 1.1])
def test_the_first_harmonic_of_a_sliding_mass_is_in_balance(frequency):
    """Both equations of motion, written as complex numbers with the relative displacement z = -|z| real.

    Absorber: Omega^2 (q + z) = own i z/|z|, so that |q|^2 = |z|^2 + (own/Omega^2)^2; oscillator:
    (1 - Omega^2 + i eps lambda Omega) q - eps own i z/|z| is the force.
    """
    G, lam, eps, pull = 3.0, 0.5, 0.05, 0.3
    q = float(friction_damper(frequency, G, lam, eps, pull, 0.0))
    own = 4.0 / math.pi * pull
    z = math.sqrt(q**2 - (own / frequency**2) ** 2)
    moved = -z + 1j * own / frequency**2
    force = (1.0 - frequency**2 + 1j * eps * lam * frequency) * moved - 1j * eps * own
    assert z > 0.0 and abs(moved) == pytest.approx(q, rel=1e-12)
    assert abs(force) == pytest.approx(eps * G, rel=1e-9)
