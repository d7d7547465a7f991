"""Right-hand sides of demos with cycles that `tools.demos` does not contain; functions of (u, p, m) as there, for forced flows of (u, p, t, m)."""

from __future__ import annotations

import numpy as np


def tor_matcont(u, nu, m, a3=0.32858, b3=0.93358, epsilon=0.001):
    """The position of epsilon follows from the source's point (0.00125003, -0.001, 0.000525025) at nu = -0.9."""
    x, y, z = u
    cube = b3 * (y - x) ** 3
    return [(-(0.5 + nu) * x + 0.5 * y - a3 * x**3 + cube) / 0.6, 0.5 * x + 0.1 * y - z - cube, y + epsilon]


def tor_coco(u, nu, m):
    return tor_matcont(u, nu, m, 0.3, 0.9, 0.0)


def plp_isola(u, rho, m, s0=111.0):
    s, a = u
    r = rho * s * a / (1 + s + 0.1 * s**2)
    return [(s0 - s) - r, 0.2 * (500 - a) - r]


def second_derivatives(n):
    """Return the matrix (n, n + 2) of second derivatives at n Chebyshev points of [0, 1], of the polynomial through these and both ends."""
    inner = (1 + np.cos((2 * np.arange(1, n + 1) - 1) * np.pi / (2 * n))) / 2
    x = np.concatenate([[0.0], inner, [1.0]])
    coefficients = np.linalg.inv(np.vander(x, increasing=True))
    k = np.arange(2, n + 2)
    return (k * (k - 1) * inner[:, None] ** (k - 2)) @ coefficients[2:]


SECOND = second_derivatives(6)


def brc(u, length, m):
    a, b = 2.0, 5.45
    x, y = np.asarray(u[:6]), np.asarray(u[6:])
    react = x**2 * y
    x2, y2 = (np.tensordot(SECOND[:, 1:7], w - end, 1) for w, end in ((x, a), (y, b / a)))
    return [*(react - (b + 1) * x + a + 0.008 / length**2 * x2), *(b * x - react + 0.004 / length**2 * y2)]


def frc(u, beta, t, m):
    v, w = u
    return [(v * (v - 0.5) * (1 - v) - w) / 0.005, v - w - (0.5 + 5.0 * m.sin(beta * t))]


def pen(u, current, m):
    """Two coupled pendula; states: cosine and sine of the mean angle (attracted to the unit circle), the difference angle, two rates."""
    c, s, apart, w1, w2 = u
    half_c, half_s = m.cos(apart / 2), m.sin(apart / 2)
    mean, back = (w1 + w2) / 2, 1 - c**2 - s**2
    return [
        -s * mean + c * back,
        c * mean + s * back,
        w2 - w1,
        -0.1 * w1 - (s * half_c - c * half_s) + current + 0.175 * apart,
        -0.1 * w2 - (s * half_c + c * half_s) + current - 0.175 * apart,
    ]


def wave(u, a0, m, speed=0.05):
    """Travelling waves of the reaction of wav with diffusion 1 and 5; unknowns are the states and their slopes."""
    s, a, ds, da = u
    r = a / (3.4 + a) * s / (1 + s + 0.023 * s * s)
    f = -3 * (210 * r - (145 - s)), -3 * (210 * r - 0.2 * (a0 - a))
    return [ds, da, -(speed * ds + f[0]), -(speed * da + f[1]) / 5]


def koper(u, current, m, kappa=-0.15):
    x, y, z = u
    return [10 * (kappa * y - x**3 + 3 * x - current), x - 2 * y + z, y - z]


def sandstede(u, mu, m, a=0.25):
    x, y, z = u
    return [
        a * x + y - a * x * x + mu * x * (2 - 3 * x),
        x + a * y - 1.5 * x * x - 1.5 * a * x * y - 2 * mu * y,
        -2 * z,
    ]


def plankton(u, fish, m, capacity=6.0):
    x, y = u
    eaten = 0.4 * x / (0.6 + x)
    return [
        0.5 * x * (1 - x / capacity) - y * eaten + 0.01 * capacity,
        0.6 * eaten * y - 0.15 * y - fish * y * y / (y * y + 0.25),
    ]


def steinmetz(u, k8, m):
    a, b, x, y = u
    k1, k3 = 0.1631021 * a * b * x, 0.046875 * a * b * y
    return [
        -k1 - k3 + 1.5 - 0.1175 * a,
        -k1 - k3 + k8,
        k1 - 2500 * x**2 + 2 * k3 - 20 * x + 0.001,
        -k3 + 2500 * x**2 - 1.104 * y,
    ]


def predator_prey(u, b0, t, m):
    x, y = u
    eaten = 12.56 * x * y / (b0 * (1 + 0.2 * m.cos(2 * m.pi * t)) + x)
    return [6.28 * x * (1 - x) - eaten, eaten - 6.28 * y]


def langford(u, rho, m, epsilon=0.0):
    x, y, z = u
    return [
        (z - 0.7) * x - 3.5 * y,
        3.5 * x + (z - 0.7) * y,
        0.6 + z - z**3 / 3 - (x * x + y * y) * (1 + rho * z) + epsilon * z * x**3,
    ]


def bistable(u, period, t, m):
    return [u[1], -0.04 * u[1] - u[0] - u[0] ** 3 + 0.015 * m.cos(2 * m.pi * t / period)]


def hopf(u, p, m):
    square = u[0] ** 2 + u[1] ** 2
    growth = p + square - square**2
    return [u[0] * growth - u[1], u[1] * growth + u[0]]


def canard(u, a, m):
    return [0.01 * (a - u[1]), u[0] + u[1] - u[1] ** 3 / 3]


def marsden(u, p, m):
    x, y, z = u
    return [p * x + y + 6 * x * x, -x + p * y + y * z, (p * p - 1) * y - x - z + x * x]


def pneta(u, epsilon, m):
    return [u[1], 0.5 * epsilon * u[1] - epsilon * u[1] ** 3 - u[0]]
