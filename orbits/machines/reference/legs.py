"""What a leg of sliding in a shaken cavity needs to know of its direction, its start, and the zero of its velocity.

Notation: :mod:`orbits.machines.reference.shaken_stepper`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from orbits.machines.digits import remainders, wrap
from orbits.numbers import ROUNDOFF
from orbits.settings import EVENTS, STEPPING

TWO_PI = 2.0 * math.pi


def fall(lo, hi, p0, q0, C, A, k0, m0):
    """The zero of p on (lo, hi], where p falls from p(lo) >= 0 to p(hi) <= 0: Newton kept inside the bracket."""
    x = hi
    for _ in range(200):
        sine, versine, third, _fourth = remainders(x)
        p = p0 + q0 * x + C * (k0 * versine - m0 * third)
        q = q0 + C * (k0 * sine - m0 * versine)
        if p > 0.0:
            lo = x
        elif p < 0.0:
            hi = x
        else:
            return x
        new = x - p / q if q < 0.0 else hi
        change = abs(new - x)
        if q < 0.0 and (
            change <= ROUNDOFF * x
            or (change <= STEPPING.last_step * x and C * change * change <= -ROUNDOFF * q * x)
        ):
            return min(max(new, lo), hi)  # what is left is of second order
        if not (lo < new < hi):
            new = 0.5 * (lo + hi)
            if hi - lo <= ROUNDOFF * hi:
                return new
        x = new
    return x


class Direction(NamedTuple):
    """One direction of sliding: A, sin alpha and alpha, cos alpha, whether the shaking ever beats A, and whether it always does.

    reach : where the wall ahead is, counted in that direction; restitution : of that wall.
    """

    pull: float
    ratio: float
    alpha: float
    beta: float
    driven: bool
    always: bool
    reach: float
    restitution: float


def direction(pull, law, reach, restitution):
    """What a leg needs to know of its direction of sliding, for the acceleration `pull` against it."""
    C = law.amplitude
    A = pull / (law.omega * law.omega)
    driven = EVENTS.zero * C < C - A
    always = A <= -C and driven
    ratio = 1.0
    if always:
        ratio = -1.0
    elif driven:
        ratio = A / C
    return Direction(
        A,
        ratio,
        math.asin(ratio),
        math.sqrt((1.0 - ratio) * (1.0 + ratio)),
        driven,
        always,
        reach,
        restitution,
    )


def directions(law):
    """The two directions of sliding: to the right wall, to the left wall."""
    return (
        direction(-law.pull_right, law, -law.right, law.restitution_right),
        direction(law.pull_left, law, law.left, law.restitution_left),
    )


def angle_of(psi, s, alpha):
    """theta: Psi for s = -1, Psi - pi for s = +1, within a turn from where q becomes positive."""
    theta = psi if s < 0.0 else (psi - math.pi if psi >= math.pi else psi + math.pi)
    if alpha < 0.0 and theta >= TWO_PI + alpha:
        theta -= TWO_PI
    return theta


def launch(law, state):
    """Reduce the phase and set the mode of a start (Psi, w, w', turns, low)."""
    psi, turns = wrap(state[0])
    state[0] = psi
    state[4] += turns
    square = law.omega * law.omega
    push = -law.amplitude * math.sin(psi)
    w = state[1]
    to_left, to_right = push > law.pull_left / square, push < law.pull_right / square
    if state[2] != 0.0:
        state[3] = 1.0 if state[2] > 0.0 else -1.0
    elif not (to_left or to_right) or (w == law.left and to_left) or (w == law.right and to_right):
        state[3] = 0.0
    else:
        state[3] = 1.0 if to_left else -1.0
