"""Closed forms of the motion after a state, for numbers and for arrays of them; see :mod:`orbits.machines.reference.law`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from orbits.arguments import ROUNDOFF, SMALLEST
from orbits.machines.reference.law import Law, Number, Response, where
from orbits.machines.stepping import MODE, PSI, RATE, V_RATE, V, W
from orbits.settings import STEPPING

NEAR = 0.03  # longest time for Taylor series to order 8, with a relative error below roundoff


class State(NamedTuple):
    """Position of the absorber in its cavity, and centre of mass, with their rates."""

    w: Number
    rate: Number
    v: Number
    v_rate: Number


class Point(NamedTuple):
    """The motion of q1 at a time after the start.

    Attributes
    ----------
    way, speed
        q1 and q1' minus their values at the start.
    mean
        Mean of q1'' since the start.
    h2, z2, h3, z3
        Second and third derivatives of the harmonic h and the free oscillation z.
    bend
        `way` minus the displacement at the initial q1'.
    """

    way: Number
    speed: Number
    mean: Number
    h2: Number
    z2: Number
    h3: Number
    z3: Number
    bend: Number


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
        q2' at the start and q2'', which is constant (not used while the absorber sticks).
    """

    omega: Number
    alpha: Number
    beta: Number
    h0: Number
    h1: Number
    z0: Number
    z1: Number
    q2_rate: Number
    q2_pull: Number

    @property
    def kappa(self) -> Number:
        """alpha^2 + beta^2."""
        return self.alpha * self.alpha + self.beta * self.beta

    def derivatives(self) -> tuple[list[Number], list[Number]]:
        """Return the derivatives of h and of z at the start, up to the eighth."""
        h, z = [self.h0, self.h1], [self.z0, self.z1]
        for _ in range(7):
            h.append(-self.omega * self.omega * h[-2])
            z.append(-2.0 * self.alpha * z[-1] - self.kappa * z[-2])
        return h, z

    def at(self, tau: Number) -> Point:
        """Return the motion after a time: from Taylor series near the start, from the closed form later."""
        if np.ndim(tau) == 0:
            return self._near(tau) if abs(tau) < NEAR else self._far(tau)
        near = np.abs(np.real(tau)) < NEAR
        with np.errstate(divide="ignore", invalid="ignore"):  # the closed form has no mean for a time of zero
            far = self._far(tau)
        return Point(*(where(near, a, b) for a, b in zip(self._near(tau), far)))

    def _near(self, tau: Number) -> Point:
        h, z = self.derivatives()
        d = [a + b for a, b in zip(h, z)]
        mean, bend = d[2] + _remainder(d, 1, tau), tau * _remainder(d, 0, tau)
        h2, z2, h3, z3 = (
            series[k] + tau * (series[k + 1] + _remainder(series, k, tau))
            for k in (2, 3)
            for series in (h, z)
        )
        return Point(tau * d[1] + bend, tau * mean, mean, h2, z2, h3, z3, bend)

    def _far(self, tau: Number) -> Point:
        s, c = np.sin(self.omega * tau), np.cos(self.omega * tau)
        H0 = self.h0 * c + self.h1 / self.omega * s
        H1 = self.h1 * c - self.omega * self.h0 * s
        decay = np.exp(-self.alpha * tau)
        cosine, sine = decay * np.cos(self.beta * tau), decay * np.sin(self.beta * tau) / self.beta
        Z0 = self.z0 * cosine + (self.z1 + self.alpha * self.z0) * sine
        Z1 = self.z1 * cosine - (self.alpha * self.z1 + self.kappa * self.z0) * sine
        Z2 = -2.0 * self.alpha * Z1 - self.kappa * Z0
        square, speed = self.omega * self.omega, (H1 - self.h1) + (Z1 - self.z1)
        way = (H0 - self.h0) + (Z0 - self.z0)
        return Point(
            way, speed, speed / tau, -square * H0, Z2, -square * H1, -2.0 * self.alpha * Z2 - self.kappa * Z1,
            way - (self.h1 + self.z1) * tau,
        )  # fmt: skip

    def start(self) -> Point:
        """Return the motion at the start."""
        h, z = self.derivatives()
        return Point(0.0, 0.0, h[2] + z[2], h[2], z[2], h[3], z[3], 0.0)

    def travel(self, tau: Number) -> Number:
        """Return the displacement of q2 after a time."""
        return (self.q2_rate + 0.5 * self.q2_pull * tau) * tau

    def fourth(self, at: Point) -> Number:
        """Return the fourth derivative of q1."""
        return -self.omega * self.omega * at.h2 - 2.0 * self.alpha * at.z3 - self.kappa * at.z2

    def driven(self, order: int) -> float:
        """Return a bound of the harmonic's derivative of this order."""
        return self.omega**order * np.hypot(self.h0, self.h1 / self.omega)

    def own(self, order: int, start: float) -> float:
        """Return a bound of the free oscillation's derivative of this order from a time on."""
        size = np.hypot(self.z0, (self.z1 + self.alpha * self.z0) / self.beta)
        return size * np.exp(-self.alpha * start) * self.kappa ** (0.5 * order)

    def derivative(self, order: int, tau: float, sliding: bool) -> tuple[float, float]:
        """Return a derivative (order 1 to 3) of q1, or of w = q1 - q2 if `sliding`, after a time; and the next derivative."""
        at = self.at(tau)
        rate, pull = (self.q2_rate + self.q2_pull * tau, self.q2_pull) if sliding else (0.0, 0.0)
        table = self.h1 + self.z1 + at.speed - rate, at.h2 + at.z2 - pull, at.h3 + at.z3, self.fourth(at)
        return table[order - 1], table[order]

    def zeros(
        self, order: int, start: float, end: float, phase: float = 0.0, sliding: bool = False
    ) -> Iterator[float]:
        """Yield the times in start < tau < end at which this derivative vanishes, by steps that cannot pass one; `phase` is that of the start."""
        drift = abs(self.q2_rate) + abs(self.q2_pull) * end if sliding and order == 1 else 0.0
        tiny = 2.0 * ROUNDOFF * (drift + 2.0 * self.driven(order) + 2.0 * self.own(order, 0.0))

        def look(tau: float) -> tuple[float, float]:
            return self.derivative(order, tau, sliding)

        while True:
            bound = self.driven(order + 2) + self.own(order + 2, start)
            start = first_zero(look, start, end, bound, tiny, phase)
            if not start < end:
                return
            yield start


def _remainder(derivatives: list[Number], order: int, t: Number) -> Number:
    """Return (f(t) - f(0))/t - f'(0) for the derivative `order` of q1, from higher derivatives."""
    total = 0.0 * derivatives[order]
    for k in range(8, order + 1, -1):
        total = (derivatives[k] + total) * t / (k - order)
    return total


def chosen(s: Number, left: Number, right: Number, stuck: Number) -> Number:
    """Return the value for sliding to the left wall (s > 0), to the right one (s < 0), or for sticking."""
    return where(s > 0, left, where(s < 0, right, stuck))


def leg(law: Law, psi: Number, x: State, s: Number) -> Oscillation:
    """Return the closed form of the flight that begins with a state, in mode s."""
    response = Response(*(chosen(s, a, a, b) for a, b in zip(law.slide, law.stuck)))
    X, Y, alpha, beta = response
    sine, cosine = np.sin(psi), np.cos(psi)
    h0, h1 = X * sine + Y * cosine, law.omega * (X * cosine - Y * sine)
    pull = chosen(s, law.pull_left, law.pull_right, 0.0 * psi)
    q2_rate = (x.v_rate - x.rate) / law.whole
    if law.prescribed:
        return Oscillation(law.omega, alpha, beta, h0, h1, 0.0 * h0, 0.0 * h1, q2_rate, pull)
    q1 = (x.v + law.eps * x.w) / law.whole
    z0, z1 = q1 - h0 + law.eps * pull, x.v_rate - law.eps * q2_rate - h1
    return Oscillation(law.omega, alpha, beta, h0, h1, z0, z1, q2_rate, pull)


def after(
    law: Law,
    q: Oscillation,
    p: Point,
    x: State,
    s: Number,
    t: Number,
    low: Number = 0.0,
) -> State:
    """Return the state after a time in this flight; `low` contains digits of w below its roundoff."""
    travel, fallen, sliding = q.travel(t), q.q2_pull * t, s != 0
    w, rate = x.w + (low + (x.rate * t + (p.bend - 0.5 * fallen * t))), x.rate + p.speed - fallen
    v, v_rate = x.v + p.way + law.eps * travel, x.v_rate + p.speed + law.eps * fallen
    return State(
        where(sliding, w, x.w),
        where(sliding, rate, 0.0 * x.rate),
        where(sliding, v, x.v + law.whole * p.way),
        where(sliding, v_rate, x.v_rate + law.whole * p.speed),
    )


def standing(state: np.ndarray, law: Law) -> State:
    """Return absorber and centre of mass from a stepper's state."""
    if law.prescribed:
        v, v_rate = law.amplitude * np.sin(state[PSI]), law.amplitude * law.omega * np.cos(state[PSI])
    else:
        v, v_rate = state[V], state[V_RATE]
    return State(state[W], state[RATE], v, v_rate)


def oscillation(state: np.ndarray, law: Law) -> Oscillation:
    """Return the closed form of the flight that begins with a stepper's state."""
    x = standing(state, law)
    return leg(law, state[PSI], x if state[MODE] != 0.0 else x._replace(rate=0.0), state[MODE])


def push(law: Law, x: State, sine: Number, cosine: Number) -> Number:
    """Return v'', which depends neither on friction nor on the slope."""
    if law.prescribed:
        return -law.omega * law.omega * (law.slide.X * sine + law.slide.Y * cosine)
    q1, q1_rate = (x.v + law.eps * x.w) / law.whole, (x.v_rate + law.eps * x.rate) / law.whole
    return -q1 - law.drag * q1_rate + law.force * (sine + law.base * cosine)


def certain(y: float, slope: float, bound: float) -> float:
    """Return a time for which y > 0 certainly stays positive if abs(y'') <= bound: the zero of y + y' h - bound h^2/2."""
    root = np.sqrt(slope * slope + 2.0 * bound * y)
    return (root + slope) / bound if slope > 0.0 else 2.0 * y / (root - slope)


def first_zero(
    look: Callable[[float], tuple[float, float]],
    start: float,
    end: float,
    bound: float,
    tiny: float,
    phase: float = 0.0,
) -> float:
    """Return the first zero in start < tau < end of a function; `end` if there is none.

    `look(tau)` returns its value and slope. With abs(y'') <= `bound`, steps of the length of `certain` approach a simple zero like Newton's
    method, from one side, and never pass one. A zero at `start` itself is not counted; the slope there gives a time without another zero.
    `tiny` is the value's roundoff, `phase` the phase at the start of the motion.
    """
    tau = start
    if bound <= SMALLEST:
        return end
    value, slope = look(tau)
    if abs(value) <= tiny + 4.0 * ROUNDOFF * (1.0 + start + abs(phase)) * abs(slope):
        tau += max(abs(slope) / bound, STEPPING.leave)
        if not tau < end:
            return end
        value, slope = look(tau)
    sign = 1.0 if value > 0.0 else -1.0
    while True:
        if sign * value <= tiny:
            return tau
        step = certain(sign * value, sign * slope, bound)
        if step <= ROUNDOFF * (1.0 + tau):
            return tau
        tau += step
        if not tau < end:
            return end
        value, slope = look(tau)
