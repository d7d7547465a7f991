"""Maps: demos of AUTO-07p, PyDSTool and MatContM, and maps of textbooks, unscaled."""

from __future__ import annotations

import numpy as np

from .demo import Demo


def logistic(x, mu, m):
    return [mu * x[0] * (1 - x[0])]


def hen(u, beta, m):
    return [u[1], 2 - beta * u[0] - u[1] ** 2]


def henon(u, a, m):
    return [1 - a * u[0] ** 2 + u[1], 0.3 * u[0]]


def prey(u, p1, m):
    return [p1 * u[0] * (1 - u[0]) - 0.2 * u[0] * u[1], 0.9 * u[1] + 0.2 * u[0] * u[1]]


def prey_fast(u, p1, m):
    return [p1 * u[0] * (1 - u[0]) - 2 * u[0] * u[1], 2 * u[0] * u[1]]


def delayed_logistic(u, r, m):
    return [r * u[0] * (1 - u[1]), u[0]]


def generalized_henon(u, alpha, m):
    x, y = u
    return [y, alpha - 0.5 * x - y**2 + 0.1 * x * y]


def adaptive_control(u, b, m):
    x, y, z = u
    k, c = 0.1, 0.1
    return [y, b * x + k + y * z, z - k * y / (c + y**2) * (b * x + k + z * y - 1)]


def ricker(x, r, m):
    return [x[0] * m.exp(r * (1 - x[0]))]


def ricker_delayed(u, r, m):
    return [u[0] * m.exp(r * (1 - u[1])), u[0]]


def leslie_gower(u, b, m):
    x, y = u
    return [b * x / (1 + x + 0.5 * y), 3 * y / (1 + 0.7 * x + y)]


def hassell(x, rate, m):
    return [rate * x[0] / (1 + x[0]) ** 6]


def host_parasitoid(u, r, m):
    n, q = u
    return [n * m.exp(r * (1 - n / 10) - 0.3 * q), n * (1 - m.exp(-0.3 * q))]


def cubic(x, r, m):
    return [r * x[0] - x[0] ** 3]


def gauss(x, beta, m):
    return [m.exp(-6.2 * x[0] ** 2) + beta]


def sine(x, r, m):
    return [r * m.sin(m.pi * x[0])]


def kopel(u, mu, m):
    x, y = u
    return [x / 2 + mu / 2 * y * (1 - y), y / 2 + mu / 2 * x * (1 - x)]


def burgers(u, b, m):
    x, y = u
    return [(1 - 0.9) * x - y**2, (1 + b + x) * y]


def age_groups(u, f, m):
    """Two stages with cannibalism, Ricker's recruitment."""
    x, y = u
    return [f * y * m.exp(-0.1 * x - 0.1 * y), 0.5 * x + 0.3 * y]


SWAP = np.eye(2)[::-1]
DEMOS = [
    Demo(
        "logistic",
        "AUTO log, PyDSTool Logistic",
        logistic,
        [0.0],
        0.1,
        (0.0, 3.5),
        "mu",
        "map",
        3,
        printed="1, 3, 1 + sqrt 6",
    ),
    Demo(
        "hen",
        "AUTO hen",
        hen,
        [1.0, 1.0],
        0.0,
        (-1.0, 1.2),
        "beta",
        "map",
        1,
        printed="closed form 1 (Neimark-Sacker: the Jacobian is beta)",
    ),
    Demo(
        "henon",
        "MatContM",
        henon,
        [0.6, 0.2],
        0.2,
        (-0.5, 1.05),
        "a",
        "map",
        3,
        printed="-0.1225, 0.3675 (Henon 1976)",
    ),
    Demo(
        "prey",
        "AUTO dd2",
        prey,
        [0.0, 0.0],
        0.1,
        (0.05, 5.0),
        "p1",
        "map",
        2,
        printed="closed form 1, 2; 3, 1 + sqrt 6 on the logistic map",
    ),
    Demo(
        "prey, fast",
        "PyDSTool DiscPredPrey",
        prey_fast,
        [0.0, 0.0],
        0.1,
        (0.0, 4.5),
        "p1",
        "map",
        2,
        printed="closed form 1, 3 on the logistic map; 2",
    ),
    Demo(
        "delayed logistic",
        "MatContM",
        delayed_logistic,
        [0.0, 0.0],
        0.5,
        (0.0, 2.5),
        "r",
        "map",
        2,
        printed="Neimark-Sacker 2",
    ),
    Demo(
        "generalized henon",
        "MatContM",
        generalized_henon,
        [0.2, 0.2],
        0.3,
        (-1.0, 2.0),
        "alpha",
        "map",
        2,
        printed="closed form -5/8 (fold), 261/160 (flip)",
    ),
    Demo("adaptive control", "MatContM", adaptive_control, [1.0, 1.0, 0.5], 0.9, (-1.3, 1.2), "b", "map", 1),
    Demo(
        "ricker",
        "MatContM",
        ricker,
        [1.0],
        1.5,
        (0.5, 2.6),
        "r",
        "map",
        2,
        printed="flips 2, 2.526 (May, Science 186 (1974) 645)",
    ),
    Demo(
        "ricker, delayed",
        "textbooks",
        ricker_delayed,
        [1.0, 1.0],
        0.5,
        (0.1, 1.5),
        "r",
        "map",
        2,
        printed="closed form 1 (the Jacobian is r)",
    ),
    Demo(
        "leslie-gower",
        "MatContM",
        leslie_gower,
        [0.0, 0.0],
        0.5,
        (0.1, 6.0),
        "b",
        "map",
        3,
        printed="closed form 1; 2; 27/7",
    ),
    Demo(
        "hassell",
        "textbooks",
        hassell,
        [0.0],
        0.5,
        (0.1, 40.0),
        "lambda",
        "map",
        3,
        printed="closed form 1; (1 - 2/6)^-6 = 11.390625",
    ),
    Demo(
        "host and parasitoid",
        "Beddington, Free and Lawton 1975",
        host_parasitoid,
        [10.0, 0.0],
        0.3,
        (0.1, 2.3),
        "r",
        "map",
        2,
        printed="closed form 2 (Ricker's)",
    ),
    Demo(
        "cubic",
        "textbooks",
        cubic,
        [0.0],
        0.5,
        (-1.5, 2.1),
        "r",
        "map",
        3,
        {"mirror": -np.eye(1)},
        printed="closed form -1, 1, 2",
    ),
    Demo("gauss", "textbooks", gauss, [0.0], -1.0, (-1.0, 1.0), "beta", "map", 2),
    Demo(
        "sine",
        "textbooks",
        sine,
        [0.0],
        0.2,
        (0.0, 0.8),
        "r",
        "map",
        2,
        printed="closed form 1/pi",
    ),
    Demo(
        "kopel",
        "Kopel 1996",
        kopel,
        [0.0, 0.0],
        0.5,
        (0.1, 3.8),
        "mu",
        "map",
        2,
        {"mirror": SWAP},
        printed="closed form 1; 3",
    ),
    Demo(
        "burgers",
        "Whitehead and Macdonald 1984",
        burgers,
        [0.0, 0.0],
        -0.5,
        (-1.0, 1.5),
        "b",
        "map",
        1,
        {"mirror": np.diag([1.0, -1.0])},
        printed="closed form 0; 0.5",
    ),
    Demo("two stages", "textbooks", age_groups, [0.0, 0.0], 0.2, (0.1, 40.0), "f", "map", 2),
]
