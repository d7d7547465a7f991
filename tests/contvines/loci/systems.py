"""Systems of the literature that several tests follow, each written once."""

import numpy as np

import contvines as cv

R = -0.1  # of the generalized Henon map


def generalized_henon(start=(-0.1, -0.1), al=0.0, be=0.5, units=(1.0, 1.0, 1.0)):
    """Gonchenko's map x' = y, y' = al - be x - y^2 + R x y, against be; x, be and al in units of their own."""
    U, P, Q = units

    def f(x, p):
        y, b, a = x / U, p.be / P, p.al / Q
        return U * np.array([y[1], a - b * y[0] - y[1] ** 2 + R * y[0] * y[1]])

    return cv.MapProblem(f, np.array(start) * U, {"al": al * Q, "be": be * P}, parameter="be")


def generalized_henon_at(trace, r=R):
    """(x, be, al) of the fixed point with determinant 1 and this trace: be - r x = 1, r x - 2 x = trace."""
    x = trace / (r - 2)
    be = 1 + r * x
    return x, be, x + be * x + x * x - r * x * x
