"""A kind of special point of one's own: neutral saddles of Bazykin's predator-prey model.

x' = x - x y / (1 + alpha x) - x^2 / 100,  y' = -y + x y / (1 + alpha x) - delta y^2 (Kuznetsov, Elements of Applied Bifurcation Theory,
3rd ed., example 8.3). At a neutral saddle the two real eigenvalues of an equilibrium add up to zero: the trace of the Jacobian vanishes
as at a Hopf point, but its determinant is negative. The test is regular there; `verify` tells the one from the other.
"""

import numpy as np

import contvines as cv


def bazykin(u, p):
    """The right-hand side."""
    x, y = u
    eaten = x * y / (1.0 + p.alpha * x)
    return [x - eaten - x**2 / 100.0, -y + eaten - p.delta * y**2]


def trace(point):
    """Of the Jacobian: zero at a neutral saddle, with a slope that is not."""
    return np.trace(point.jacobian)


NEUTRAL_SADDLE = cv.Kind(
    "neutral-saddle",
    "NSD",
    test=trace,
    locus=trace,
    verify=lambda point: np.linalg.det(point.jacobian) < 0.0,
    text="neutral saddle",
)


def main(delta=0.15):
    """The graph of equilibria against alpha, with neutral saddles."""
    problem = cv.AlgebraicProblem(bazykin, [20.0, 5.5], {"alpha": 0.4, "delta": delta}, spectrum="flow")
    return cv.diagram(problem, over="alpha", within=(0.05, 1.2), kinds=[*cv.KINDS, NEUTRAL_SADDLE])


if __name__ == "__main__":
    print(main())
