"""The orbit of the benchmarks: P_2^1 of the reduced absorber, with its word repeated l/2 times, and the interval of its branch.

It begins with the closed form of the symmetric orbit: with beta = (B - pi a/(2 Omega))/Omega and
H = (pi/2) a/Omega^2, C sin Psi = 1 - (pi/2) beta and C cos Psi = R beta + H.
"""

import math

import numpy as np

PARAMS = np.array(
    [0.3, 0.76, 0.5, 0.211, 0.006, 1.0]
)  # amplitude, restitution, friction, gravity, mass ratio, frequency
INTERVAL = (0.2, 0.7)
STEP = 2e-3  # largest step; the branch then has about a thousand points
TOLERANCE = 1e-8
ANGLE = 0.1


def symmetric_orbit(beta, params=PARAMS):
    """Return (Psi, B) after the impact on the left wall, and the amplitude C, of the symmetric orbit with this beta."""
    r, mu, g, eps, omega = params[1:]
    a = (1.0 + eps) * mu * g
    R, H = (1.0 - r) / (1.0 + r), 0.5 * math.pi * a / omega**2
    sine, cosine = 1.0 - 0.5 * math.pi * beta, R * beta + H
    return math.atan2(sine, cosine), omega * beta + 0.5 * math.pi * a / omega, math.hypot(sine, cosine)


def start(l, beta=0.65, change=1e-6):
    """Return nodes (2 l,), amplitude and unit tangent (2 l + 1,) of the orbit repeated l/2 times; the metric is that of the continuation.

    `change` is the step of the difference quotient for the tangent, which points to larger beta.
    """

    def nodes(b):
        psi, speed, amplitude = symmetric_orbit(b)
        first = np.array([[psi, speed], [psi + math.pi, -speed]])
        shifts = 2.0 * math.pi * np.arange(l // 2)
        u = np.tile(first, (l // 2, 1))
        u[:, 0] += np.repeat(shifts, 2)
        return np.append(u.ravel(), amplitude)

    tangent = (nodes(beta + change) - nodes(beta - change)) / (2.0 * change)
    metric_u, metric_p = metric(l)
    tangent /= math.sqrt(metric_u * tangent[:-1] @ tangent[:-1] + metric_p * tangent[-1] ** 2)
    here = nodes(beta)
    return here[:-1], here[-1], tangent


def metric(l):
    """Return the weights of the unknowns and of the parameter, with which steps depend neither on l nor on units."""
    return 1.0 / (2 * l), 1.0 / (INTERVAL[1] - INTERVAL[0]) ** 2
