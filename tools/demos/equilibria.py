"""Equilibria: demos of AUTO-07p, MatCont, BifurcationKit, PyDSTool and COCO, unscaled."""

from __future__ import annotations


def ab(u, p, m):
    r = p * (1 - u[0]) * m.exp(u[1])
    return [-u[0] + r, -3 * u[1] + 14 * r]


def abc(u, d, m, beta=1.55):
    e, rest, s = m.exp(u[2]), 1 - u[0], 0.04
    return [
        -u[0] + d * rest * e,
        -u[1] + d * e * (rest - s * u[1]),
        -u[2] - beta * u[2] + d * 8 * e * (rest + s * u[1]),
    ]


def pp2(u, p, m):
    return [3 * u[0] * (1 - u[0]) - u[0] * u[1] - p * (1 - m.exp(-5 * u[0])), -u[1] + 3 * u[0] * u[1]]


def pp3(u, p, m):
    return [
        u[0] * (1 - u[0]) - 4 * u[0] * u[1],
        -0.25 * u[1] + 4 * u[0] * u[1] - 3 * u[1] * u[2] - p * (1 - m.exp(-5 * u[1])),
        -0.5 * u[2] + 3 * u[1] * u[2],
    ]


def plp(u, rho, m):
    s, a = u
    r = rho * s * a / (1 + s + 0.1 * s**2)
    return [(110 - s) - r, 0.2 * (500 - a) - r]


def wav(u, a0, m):
    r = u[1] / (3.4 + u[1]) * u[0] / (1 + u[0] + 0.023 * u[0] * u[0])
    return [-3 * (210 * r - (145 - u[0])), -3 * (210 * r - 0.2 * (a0 - u[1]))]


def enz(u, s0, m):
    def r(s):
        return s / (1 + s + s**2)

    return [(s0 - u[0]) + (u[1] - u[0]) - 100 * r(u[0]), (s0 - u[1]) + (u[0] - u[1]) - 100 * r(u[1])]


def cusp(u, mu, m):
    return [mu + u[0] - u[0] ** 3]


def chu(u, alpha, m):
    def ab(x):
        return 2 * x * m.atan(10 * x) / m.pi

    x, y, z = u
    h = 2 * x / 7 + (-1 / 7 - 2 / 7) / 2 * (ab(x + 1) - ab(x - 1))
    return [alpha * (y - h), x - y + z, -14.3 * y]


def lorenz(u, r, m):
    return [10 * (u[1] - u[0]), r * u[0] - u[1] - u[0] * u[2], u[0] * u[1] - 8 * u[2] / 3]


def tor(u, nu, m):
    x, y, z = u
    be, ga, r, a3, b3 = 0.5, -0.6, 0.6, 0.328578, 0.933578
    return [
        (-(be + nu) * x + be * y - a3 * x**3 + b3 * (y - x) ** 3) / r,
        be * x - (be + ga) * y - z - b3 * (y - x) ** 3,
        y,
    ]


def fhn(u, a, m):
    return [3 * (u[0] - u[0] ** 3 / 3 + u[1]), -(u[0] - a + 0.8 * u[1]) / 3]


def phs(u, p, m):
    return [-p * u[0] - u[1], u[0] * (1 - u[0])]


def ops(u, p3, m):
    x, y, z = u
    return [(-2 * (x**3 / 3 - x) + (z - x) / 4 - y) / 0.5, x - p3, -(z - x) / 4]


def bru(u, b, m):
    return [2 - (b + 1) * u[0] + u[0] ** 2 * u[1], b * u[0] - u[0] ** 2 * u[1]]


def oxidation(u, q2, m):
    x, y, s = u
    z = 1 - x - y - s
    return [5 * z * z - 2 * x * x - 10 * x * y, q2 * z - 0.1 * y - 10 * x * y, 0.0675 * (z - 0.4 * s)]


def bazykin(u, alpha, m):
    x, y = u
    eaten = x * y / (1 + alpha * x)
    return [x - eaten - 0.01 * x * x, -y + eaten - 0.1 * y * y]


def morris_lecar(u, current, m, g=4.4, v3=2.0, v4=30.0, phi=0.04):
    v, w = u
    calcium, potassium = (1 + m.tanh((v + 1.2) / 18)) / 2, (1 + m.tanh((v - v3) / v4)) / 2
    flow = 2 * (v + 60) + g * calcium * (v - 120) + 8 * w * (v + 84)
    return [(current - flow) / 20, phi * m.cosh((v - v3) / (2 * v4)) * (potassium - w)]


def morris_lecar_1(u, current, m):
    return morris_lecar(u, current, m, 4.0, 12.0, 17.4, 0.066)


def adaptx(u, alpha, m):
    return [u[1], u[2], -alpha * u[2] - u[1] - u[0] + u[0] ** 2]


def lorenz84(u, f, m):
    x, y, z, w = u
    return [
        -(y**2) - z**2 - x / 4 + f / 4 - 0.987 * w**2,
        x * y - x * z - y + 0.25,
        x * y + x * z - z,
        -1.04 * w + 0.987 * w * x + 0.04,
    ]


def new_lorenz(u, f, m):
    x, y, z = u
    return [-y * y - z * z - x / 4 + f / 4, x * y - 4 * x * z - y + 0.5, 4 * x * y + x * z - z]
