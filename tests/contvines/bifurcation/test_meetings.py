"""Where a branch comes back to more symmetric solutions its equations are singular: nothing is told right beside that place."""

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import contvines as cv
from orbits import Absorber

R, MU, G, EPS = 0.7412949593424256, 0.6717705527573615, 0.49330139247723326, 0.006
A = (1.0 + EPS) * MU * G


def half(psi, rate, amplitude, guess):
    """From the left wall to the right one, seen as from left again: phase and speed after the impact, complex arguments allowed."""
    t = complex(guess)
    for _ in range(50):
        w = 2.0 + rate * t + amplitude * (np.sin(psi + t) - np.sin(psi) - t * np.cos(psi)) + 0.5 * A * t * t
        speed = rate + amplitude * (np.cos(psi + t) - np.cos(psi)) + A * t
        t = t - w / speed
    return psi + t - np.pi, R * speed


def symmetric(amplitude):
    """Phase and speed of the symmetric LR orbit."""
    return fsolve(
        lambda x: np.real(np.array(half(x[0], x[1], amplitude, np.pi)) - x), [5.56, -0.865], xtol=1e-14
    )


def breaking(amplitude):
    """det(J + 1) of the half return map: zero where an orbit of less symmetry leaves."""
    psi, rate = symmetric(amplitude)
    h = 1e-25
    columns = [half(psi + 1j * h, rate, amplitude, np.pi), half(psi, rate + 1j * h, amplitude, np.pi)]
    jacobian = np.imag(np.array(columns)).T / h
    return float(np.linalg.det(jacobian + np.eye(2)))


WIDE = (0.6825272462790698, 1.4825272462790697)


@pytest.mark.parametrize(
    ("within", "max_step", "angle"),
    [(WIDE, 0.003, 0.01), ((0.85, 1.1), 0.003, 0.01), ((0.85, 1.1), 0.03, 0.05), ((0.85, 1.1), 0.1, 0.2)],
)
def test_only_the_symmetry_breaking_itself_is_found(within, max_step, angle):
    machine = Absorber(restitution=R, friction=MU, gravity=G, mass_ratio=EPS)
    guess = [
        [5.94012221, 1.92439665], [8.12384666, -1.38942895], [9.15870552, -0.49935058], [9.73782465, -0.49935058],
    ]  # fmt: skip
    start = machine.orbit("LRs", guess=guess, amplitude=1.0825272462790698)
    settings = {"max_step": max_step, "angle": angle}
    graph = cv.diagram(start, over="amplitude", within=within, depth=0, settings=settings)
    near = [point for point in graph.special.values() if abs(point.value - graph["SB1"].value) < 1e-3]
    assert [point.kind for point in near] == ["symmetry-breaking"]
    expected = brentq(breaking, 0.88, 0.92, xtol=1e-14)
    assert graph["SB1"].value == pytest.approx(expected, abs=1e-9)
