"""Systems of the literature that several tests follow, each written once."""

import numpy as np

import contvines as cv

R = -0.1  # of the generalized Henon map


def generalized_henon(start=(-0.1, -0.1), al=0.0, be=0.5, units=(1.0, 1.0, 1.0), r=R):
    """Gonchenko's map x' = y, y' = al - be x - y^2 + r x y, against be; x, be and al in units of their own."""
    U, P, Q = units

    def f(x, p):
        y, b, a = x / U, p.be / P, p.al / Q
        return U * np.array([y[1], a - b * y[0] - y[1] ** 2 + r * y[0] * y[1]])

    return cv.MapProblem(f, np.array(start) * U, {"al": al * Q, "be": be * P}, parameter="be")


def generalized_henon_at(trace, r=R):
    """(x, be, al) of the fixed point with determinant 1 and this trace: be - r x = 1, r x - 2 x = trace."""
    x = trace / (r - 2)
    be = 1 + r * x
    return x, be, x + be * x + x * x - r * x * x


def bautin(x, p):
    """r' = r (mu + b r^2 - r^4): cycles fold where b^2 + 4 mu = 0 with b > 0, r^2 = b / 2."""
    square = x[0] ** 2 + x[1] ** 2
    growth = p.mu + p.b * square - square**2
    return [growth * x[0] - x[1], x[0] + growth * x[1]]


def bazykin(x, p):
    """Bazykin's predator and prey: Kuznetsov's example 8.3."""
    eaten = x[0] * x[1] / (1 + p.alpha * x[0])
    return [x[0] - eaten - 0.01 * x[0] ** 2, -x[1] + eaten - p.delta * x[1] ** 2]


# where F, trace and determinant vanish: mpmath, thirty digits
BAZYKIN_DOUBLE_ZERO = 0.45362432777812945521, 0.17512759295021742421
BAZYKIN_PLACE = 6.26576552895236307, 3.60155393683666477


def henon(x, p):
    """x' = 1 + y - a x^2, y' = b x."""
    return [1 + x[1] - p.a * x[0] ** 2, p.b * x[0]]


def henon_of(x, a):
    """The same with b = 0.3, its only parameter a."""
    return [1 - a * x[0] ** 2 + x[1], 0.3 * x[0]]


def cusp(x, p):
    """x' = b + (a - 1/3) x - x^3: folds from a = 1/3 on, where their cusp is, at b = 0."""
    return [p.b + (p.a - 1 / 3) * x[0] - x[0] ** 3]
