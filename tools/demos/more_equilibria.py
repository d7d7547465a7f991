"""Equilibria: demos of MatCont, BifurcationKit, PyDSTool and XPPAUT, unscaled (the second part)."""

from __future__ import annotations


def squid(u, current, m):
    v, a, h, n = u
    rise = (
        0.1 * (25 - v) / (m.exp((25 - v) / 10) - 1),
        0.07 * m.exp(-v / 20),
        0.01 * (10 - v) / (m.exp((10 - v) / 10) - 1),
    )
    fall = 4 * m.exp(-v / 18), 1 / (m.exp((30 - v) / 10) + 1), 0.125 * m.exp(-v / 80)
    flow = 120 * a**3 * h * (v - 115) + 36 * n**4 * (v + 12) + 0.3 * (v - 10.6)
    return [current - flow, *(r * (1 - x) - f * x for r, f, x in zip(rise, fall, (a, h, n)))]


def neural_mass(u, e0, m):
    e, x, w = u
    drive = 1.5 * m.log(1 + m.exp((3.07 * w * x * e + e0) / 1.5))
    return [(-e + drive) / 0.013, (1 - x) / 0.2 - w * e * x, 0.3 * e * (1 - w) - (w - 0.3) / 1.5]


def steinmetz(u, k7, m):
    a, b, x, y = u
    k1, k3 = 0.1631021 * a * b * x, 0.046875 * a * b * y
    return [
        -k1 - k3 + k7 - 0.1175 * a,
        -k1 - k3 + 0.75,
        k1 - 2500 * x**2 + 2 * k3 - 20 * x + 0.001,
        -k3 + 2500 * x**2 - 1.104 * y,
    ]


def colpitts(u, mu, m):
    def f(x):
        return 1e-16 * (m.exp(40 * x) - 1)

    a, b, c, d = u
    return [(a - 6) * 4 - f(b) + f(a) / 0.99, c + f(b) / 0.5 - f(a), -c - d, -mu + b]


def hindmarsh_rose_fast(u, z, m):
    return [u[1] - u[0] ** 3 + 3 * u[0] ** 2 + 2 - z, 1 - 5 * u[0] ** 2 - u[1]]


def hindmarsh_rose(u, i, m):
    x, y, z = u
    return [y - x**3 + 3 * x**2 + i - z, 1 - 5 * x**2 - y, 0.001 * (4 * (x + 1.618033988749895) - z)]


def brusselator_cells(u, rate, m):
    x, y = u[:3], u[3:]
    around = [(1, 2), (2, 0), (0, 1)]
    return [
        *(
            x[a] - 2 * x[i] + x[b] + rate * (2.1 - 4.5 * x[i] + x[i] ** 2 * y[i])
            for i, (a, b) in enumerate(around)
        ),
        *(
            10 * (y[a] - 2 * y[i] + y[b]) + rate * (3.5 * x[i] - x[i] ** 2 * y[i])
            for i, (a, b) in enumerate(around)
        ),
    ]


def two_patches(u, k, m):
    v1, v2, p1, p2 = u
    h, mu, d = 0.5, 0.8, 0.5
    return [
        v1 * (1 - v1 / k) - v1 * p1 / (1 + h * v1),
        v2 * (1 - v2 / k) - v2 * p2 / (1 + h * v2),
        -mu * p1 + v1 * p1 / (1 + h * v1) + d * (p2 - p1),
        -mu * p2 + v2 * p2 / (1 + h * v2) + d * (p1 - p2),
    ]


def hamiltonian(u, a, m):
    return [u[1] + a * (u[0] ** 3 - u[0]), u[0] - u[0] ** 3 + a * u[1]]


def van_der_pol(u, a, m):
    return [(u[1] - (u[0] ** 3 / 3 - u[0])) / 0.1, a - u[0]]


def level_curve(u, x, m):
    return [x * x / 2 + u[0] ** 2 - 1]


def saddle_node(u, r, m):
    return [r - u[0] ** 2]


def nerve(u, current, m):
    return [u[0] - u[0] ** 3 / 3 - u[1] + current, 0.08 * (u[0] + 0.7 - 0.8 * u[1])]


def chan(u, alpha, m, n=21):
    inner = [
        (u[i - 1] - 2 * u[i] + u[i + 1]) * (n - 1) ** 2
        + alpha * (1 + (u[i] + u[i] ** 2 / 2) / (1 + u[i] ** 2 / 100))
        for i in range(1, n - 1)
    ]
    return [u[0] - 0.01, *inner, u[n - 1] - 0.01]


def bratu(u, p, m, n=9):
    full = [0, *u, 0]
    return [
        (full[i - 1] - 2 * full[i] + full[i + 1]) * (n + 1) ** 2 + p * m.exp(full[i]) for i in range(1, n + 1)
    ]
