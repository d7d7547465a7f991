"""Margins of admissibility of orbits of an absorber on its oscillator."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.machines.reference.law import Law
from orbits.machines.reference.oscillation import (
    Oscillation,
    Point,
    State,
    after,
    certain,
    first_zero,
    leg,
    push,
)
from orbits.numbers import ROUNDOFF, SMALLEST
from orbits.settings import STEPPING
from orbits.words.alphabet import CODES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from orbits.arguments import CycleData, Workspace

TURN, STICK, SLIP = (CODES[letter] for letter in "tsu")


def margins(law: Law[float], data: CycleData, u: np.ndarray, work: Workspace, out: np.ndarray) -> None:
    """Margins of admissibility, none negative for an orbit that a machine can follow.

    `out` has shape (4 L,), four numbers per node; infinity where there is nothing to watch. Reads sines and cosines of the last `linearise` from
    `work`. All zeros are found by steps that cannot pass one (`orbits.machines.reference.oscillation.first_zero`).

    0. The flight after the node. Sliding: smallest s w' at an interior minimum. Without friction, where a flight may reverse: distance from the
       walls at the zeros of w'. Stuck: smallest a - |v'' - b| at an interior extremum.
    1. The event. Impact: approach speed. Turn: -s (v'' - b) - a with s the mode before, since the relative acceleration v'' - b - a S cannot
       vanish for any S in [-1, 1] exactly when |v'' - b| > a. Stick: a - |v'' - b|. Slip: m v''' at its start. Here neither friction nor gravity
       enters v'' = -q1 - eps lambda q1' + e + eps lambda e', and b = (1 + eps) g sin(slope).
    2. The wall: distance from it away from impacts.
    3. The duration of the segment.
    """
    events, modes, twist = data.events, data.modes, data.twist
    length = len(events)
    a, b = law.whole * law.friction_left, law.whole * law.lean
    for i in range(length):
        event, mode = events[i], float(modes[i])
        psi, y, v, v_rate = u[4 * i : 4 * i + 4]
        inner = i + 1 < length
        arrival = events[(i + 1) % length]
        if not inner and twist < 0.0 and arrival < TURN:
            arrival = 1 - arrival
        d = ((u[4 * i + 4] if inner else u[0] + data.shift) - psi) / law.omega
        begin = State(1.0 - 2.0 * event, v_rate - y, v, v_rate) if event < TURN else State(y, 0.0, v, v_rate)
        against = push(law, begin, work.sines[i], work.cosines[i]) - b  # friction
        q = leg(law, psi, begin, mode)
        first = q.start()
        jerk = first.h3 + first.z3
        flight = np.inf
        if not d > 0.0:
            pass
        elif mode == 0.0:
            for at in _extrema(q, 3, psi, d):
                flight = min(flight, a - abs(law.whole * (at.h2 + at.z2) - b))
        elif a > 0.0:
            tau = 0.0
            if event == SLIP:  # w' = w'' = 0 at the start of a slip: go as far as m w''' keeps its sign
                bound = q.driven(4) + q.own(4, 0.0)
                tau = min(abs(jerk) / bound, 0.5 * d) if bound > 0.0 else 0.0
            if event != TURN or mode * against > a:  # else the turn's own margin says it
                flight = _slowest(law, q, mode, tau, d)
        else:
            tau = 0.0
            while (tau := first_zero(_slide(q), tau, d, *_bounds(q, 1, tau, d), psi)) < d:
                flight = min(flight, 1.0 - abs(after(law, q, q.at(tau), begin, mode, tau).w))
        before = modes[i - 1] if i > 0 else twist * modes[-1]
        out[4 * i] = flight
        out[4 * i + 2] = 1.0 - abs(y) if event >= TURN else np.inf
        out[4 * i + 3] = d
        if event == TURN:
            out[4 * i + 1] = -before * against - a
        elif event == STICK:
            out[4 * i + 1] = a - abs(against)
        elif event == SLIP:
            out[4 * i + 1] = mode * jerk  # w''' of the slide that begins
        if arrival < TURN:  # the wall's reaction: w'+ = -r w'-, and B+ = v' - w'+
            k = 4 * (i + 1) if inner else 0
            rate = (1.0 if inner else twist) * (u[k + 1] - u[k + 3])
            out[k + 1] = (1.0 - 2.0 * arrival) * rate / law.restitution_left


def _bounds(q: Oscillation[float], order: int, start: float, end: float) -> tuple[float, float]:
    """Of a derivative of q1: what bounds its second derivative from a time on, and its rounding."""
    drift = abs(q.q2_rate) + abs(q.q2_pull) * end if order == 1 else 0.0
    return q.driven(order + 2) + q.own(order + 2, start), 2.0 * ROUNDOFF * (
        drift + 2.0 * q.driven(order) + 2.0 * q.own(order, 0.0)
    )


def _slide(q: Oscillation[float]) -> Callable[[float], tuple[float, float]]:
    """w' and w'' by time."""

    def look(tau: float) -> tuple[float, float]:
        at = q.at(tau)
        return q.h1 + q.z1 + at.speed - (q.q2_rate + q.q2_pull * tau), at.h2 + at.z2 - q.q2_pull

    return look


def _extrema(q: Oscillation[float], order: int, psi: float, end: float) -> Iterator[Point[float]]:
    """The motion where q1''' vanishes."""

    def look(tau: float) -> tuple[float, float]:
        at = q.at(tau)
        return at.h3 + at.z3, q.fourth(at)

    tau = 0.0
    while (tau := first_zero(look, tau, end, *_bounds(q, order, tau, end), psi)) < end:
        at: Point[float] = q.at(tau)
        yield at


def _slowest(law: Law[float], q: Oscillation[float], s: float, start: float, end: float) -> float:
    """Smallest s w' at an interior minimum on start < tau < end of a slide, infinity if there is none.

    w'' = q1'' - q2'' is followed from zero to zero by steps that cannot pass one (`certain`); the fourth derivative of q1 is an oscillator's
    response to a force of amplitude Omega^4 `strength`, which bounds it. A zero need not be known well (`STEPPING.minimum`): the minimum is then taken from
    the Taylor series, exact to roundoff.
    """
    brake = s * q.q2_pull
    smallest, tau, bound = np.inf, start, -1.0
    while True:
        at = q.at(tau)
        y, slope = s * (at.h2 + at.z2) - brake, s * (at.h3 + at.z3)
        if bound < 0.0:
            bound = np.sqrt(q.fourth(at) ** 2 + q.fifth(at) ** 2 / q.kappa)
            bound += q.omega**4 * law.strength * (end - start) / np.sqrt(q.kappa)
            if not bound > SMALLEST:
                return smallest
        sign = 1.0 if y > 0.0 else -1.0
        step = certain(abs(y), sign * slope, bound)
        if step < STEPPING.minimum:
            zero = -y / slope if sign * slope < 0.0 else 0.0
            if tau + zero >= end:
                return smallest
            if slope > 0.0:
                speed = s * (q.h1 + q.z1 + at.speed - q.q2_rate) - brake * tau
                smallest = min(smallest, speed + (y + 0.5 * slope * zero) * zero)
            step = zero + max(abs(slope) / bound, STEPPING.minimum)
        tau += step
        if not tau < end:
            return smallest
