"""Coefficients of normal forms that can be worked out by hand."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms


def flow(function, size):
    return Forms(
        cv.AlgebraicProblem(function, np.zeros(size), 0.0, spectrum="flow", scale=1.0), np.zeros(size), 0.0
    )


@pytest.mark.parametrize(("slaved", "own"), [(0.0, -1.0), (0.5, 0.0), (-0.8, 0.3)])
def test_a_pitchfork_with_a_slaved_unknown(slaved, own):
    """x' = p x + x w + c x^3, w' = -w + b x^2: on the centre manifold w = b x^2, so x' = (b + c) x^3."""
    forms = flow(
        lambda u, p: np.array([p * u[0] + u[0] * u[1] + own * u[0] ** 3, -u[1] + slaved * u[0] ** 2]), 2
    )
    assert forms.cubic(0.0).value == pytest.approx(slaved + own, rel=1e-5)


OMEGA = 1.4


def planar(f, g):
    """x' = -omega y + f, y' = omega x + g, f and g by their monomials {(i, j): coefficient of x^i y^j}."""

    def F(u, p):
        x, y = u
        return np.array(
            [
                -OMEGA * y + sum(c * x**i * y**j for (i, j), c in f.items()),
                OMEGA * x + sum(c * x**i * y**j for (i, j), c in g.items()),
            ]
        )

    return F


def by_hand(f, g):
    """16 a of Guckenheimer and Holmes, (3.4.11): third derivatives, and products of second ones over omega."""

    def d(part, i, j):
        return part.get((i, j), 0.0) * np.prod(np.arange(1, i + 1)) * np.prod(np.arange(1, j + 1))

    third = d(f, 3, 0) + d(f, 1, 2) + d(g, 2, 1) + d(g, 0, 3)
    second = d(f, 1, 1) * (d(f, 2, 0) + d(f, 0, 2)) - d(g, 1, 1) * (d(g, 2, 0) + d(g, 0, 2))
    return third + (second - d(f, 2, 0) * d(g, 2, 0) + d(f, 0, 2) * d(g, 0, 2)) / OMEGA


@pytest.mark.parametrize("seed", range(4))
def test_a_hopf_point_of_any_plane_system(seed):
    """Up to the length of the critical vector, which the radial cubic -x (x^2 + y^2) tells."""
    radial = ({(3, 0): -1.0, (1, 2): -1.0}, {(2, 1): -1.0, (0, 3): -1.0})
    draw = np.random.default_rng(seed)
    powers = [(i, j) for i in range(4) for j in range(4) if 2 <= i + j <= 3]
    drawn = tuple({power: float(draw.uniform(-1.0, 1.0)) for power in powers} for _ in range(2))
    unit, found = (flow(planar(*parts), 2).lyapunov(1j * OMEGA)[0].value for parts in (radial, drawn))
    assert unit < 0.0
    assert found / unit == pytest.approx(by_hand(*drawn) / by_hand(*radial), rel=1e-5)
