"""The motion of the absorber on its oscillator from a state on, in closed form.

Between two events q1 is a constant plus a harmonic h of the forcing plus a damped oscillation z of its own, and q2 a parabola;
see :mod:`orbits.machines.coupled.flow`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from orbits.machines.stepping import MODE, PSI, RATE, V_RATE, V, W

NEAR = 0.03  # Taylor series to order 8 up to here: relative error below roundoff


class Numbers(NamedTuple):
    """The machine's parameters, in the order of `orbits.machines.coupled.machine.Coupled.table`."""

    forcing: float
    frequency: float
    damping: float
    mass_ratio: float
    restitution: float
    friction: float
    gravity: float
    excitation: float
    slope: float

    @classmethod
    def of(cls, params: Any) -> Numbers:
        """From a parameter vector; that of a machine with units has its scales behind them."""
        return cls(*params[: len(cls._fields)])

    @property
    def whole(self) -> float:
        """1 + eps."""
        return 1.0 + self.mass_ratio

    @property
    def drag(self) -> float:
        """eps lambda."""
        return self.mass_ratio * self.damping

    @property
    def pull(self) -> float:
        """mu g cos(slope), the absorber's acceleration by friction."""
        return self.friction * self.gravity * math.cos(self.slope)

    @property
    def lean(self) -> float:
        """g sin(slope), its acceleration by gravity along the cavity."""
        return self.gravity * math.sin(self.slope)


class Point(NamedTuple):
    """q1 and q1' less those at the start; second and third derivatives of h and of z."""

    way: float
    speed: float
    h2: float
    z2: float
    h3: float
    z3: float


@dataclass(frozen=True)
class Oscillation:
    """The motion of q1, and q2' and q2'' at its start.

    Parameters
    ----------
    omega, alpha, beta : float
        Forcing frequency; decay rate and frequency of the free oscillation.
    h0, h1, z0, z1 : float
        Harmonic and free oscillation with their rates at the start.
    q2_rate, q2_pull : float
        q2' at the start and q2'', which is constant (of no use while the absorber sticks).
    """

    omega: float
    alpha: float
    beta: float
    h0: float
    h1: float
    z0: float
    z1: float
    q2_rate: float = 0.0
    q2_pull: float = 0.0

    @property
    def kappa(self) -> float:
        """alpha^2 + beta^2."""
        return self.alpha * self.alpha + self.beta * self.beta

    def series(self) -> tuple[list[float], list[float]]:
        """Derivatives of h and of z at the start, up to the eighth."""
        h, z = [self.h0, self.h1], [self.z0, self.z1]
        for _ in range(7):
            h.append(-self.omega * self.omega * h[-2])
            z.append(-2.0 * self.alpha * z[-1] - self.kappa * z[-2])
        return h, z

    def at(self, tau: float) -> Point:
        """The motion after a time: from Taylor series close to the start, from the closed form beyond."""
        if tau < NEAR:
            h, z = self.series()
            d = [a + b for a, b in zip(h, z)]
            higher = (of[k] + _increment(of, k, tau) for k in (2, 3) for of in (h, z))
            return Point(_increment(d, 0, tau), _increment(d, 1, tau), *higher)
        s, c = math.sin(self.omega * tau), math.cos(self.omega * tau)
        H0 = self.h0 * c + self.h1 / self.omega * s
        H1 = self.h1 * c - self.omega * self.h0 * s
        decay = math.exp(-self.alpha * tau)
        cosine = decay * math.cos(self.beta * tau)
        sine = decay * math.sin(self.beta * tau) / self.beta
        Z0 = self.z0 * cosine + (self.z1 + self.alpha * self.z0) * sine
        Z1 = self.z1 * cosine - (self.alpha * self.z1 + self.kappa * self.z0) * sine
        Z2 = -2.0 * self.alpha * Z1 - self.kappa * Z0
        square = self.omega * self.omega
        return Point(
            (H0 - self.h0) + (Z0 - self.z0), (H1 - self.h1) + (Z1 - self.z1),
            -square * H0, Z2, -square * H1, -2.0 * self.alpha * Z2 - self.kappa * Z1,
        )  # fmt: skip

    def start(self) -> Point:
        """The motion at the start."""
        h, z = self.series()
        return Point(0.0, 0.0, h[2], z[2], h[3], z[3])

    def travel(self, tau: float) -> float:
        """The way of q2 after a time."""
        return (self.q2_rate + 0.5 * self.q2_pull * tau) * tau

    def fourth(self, at: Point) -> float:
        """The fourth derivative of q1."""
        return -self.omega * self.omega * at.h2 - 2.0 * self.alpha * at.z3 - self.kappa * at.z2

    def fifth(self, at: Point) -> float:
        """The fifth derivative of q1."""
        own = 2.0 * self.alpha * (2.0 * self.alpha * at.z3 + self.kappa * at.z2) - self.kappa * at.z3
        return own - self.omega * self.omega * at.h3


def _increment(derivatives: list[float], order: int, t: float) -> float:
    """f(t) - f(0) of the derivative `order`, from those above it."""
    total = 0.0
    for k in range(8, order, -1):
        total = (derivatives[k] + total) * t / (k - order)
    return total


def response(mass: float, numbers: Numbers) -> tuple[float, float]:
    """X and Y of X sin Psi + Y cos Psi, the answer of a mass to the moving base; infinite at an undamped resonance."""
    force = numbers.mass_ratio * numbers.forcing
    drag = numbers.drag * numbers.frequency
    stiffness = 1.0 - mass * numbers.frequency * numbers.frequency
    size = stiffness * stiffness + drag * drag
    if force == 0.0:
        return 0.0, 0.0
    if size == 0.0:
        return math.inf, math.inf
    scale = force / size
    chi = numbers.excitation
    return scale * (stiffness + chi * drag * drag), scale * drag * (chi * stiffness - 1.0)


def own_rates(mass: float, numbers: Numbers) -> tuple[float, float]:
    """Decay rate alpha and frequency beta of mass z'' + eps lambda z' + z = 0; beta is NaN when overdamped."""
    alpha = 0.5 * numbers.drag / mass
    square = 1.0 / mass - alpha * alpha
    return alpha, np.sqrt(square) if square > 0.0 else math.nan


def oscillation(state: np.ndarray, numbers: Numbers) -> Oscillation:
    """The closed form of the leg that begins with a state."""
    s, omega, eps = state[MODE], numbers.frequency, numbers.mass_ratio
    mass, rate = (1.0, state[RATE]) if s != 0.0 else (numbers.whole, 0.0)
    X, Y = response(mass, numbers)
    pull = s * numbers.pull + numbers.lean if s != 0.0 else 0.0
    q2_rate = (state[V_RATE] - rate) / numbers.whole
    q1 = (state[V] + eps * state[W]) / numbers.whole
    sine, cosine = math.sin(state[PSI]), math.cos(state[PSI])
    h0, h1 = X * sine + Y * cosine, omega * (X * cosine - Y * sine)
    return Oscillation(
        omega, *own_rates(mass, numbers),
        h0, h1, q1 - h0 + eps * pull, state[V_RATE] - eps * q2_rate - h1, q2_rate, pull,
    )  # fmt: skip


def certain(y: float, slope: float, bound: float) -> float:
    """Time for which y > 0 stays positive when abs(y'') <= bound: the zero of y + y' h - bound h^2/2."""
    root = np.sqrt(slope * slope + 2.0 * bound * y)
    return (root + slope) / bound if slope > 0.0 else 2.0 * y / (root - slope)
