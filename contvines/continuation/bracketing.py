"""Bracketing: find the root of a function of one variable, one evaluation at a time.

Chandrupatla's method (Adv. Eng. Software 28 (1997) 145): bisection, with inverse quadratic steps where they are safe; the function need
not be continuous. If these steps are not safe, as at a jump or a kink, secants through points on one side of the zero replace bisection, as
values on the other side give no information on the zero.

native/march.hpp has the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from contvines.shared.numbers import TINY

from .settings import SOLUTION

BISECTIONS = 2  # number of bisections before secants on one side are tried
ENOUGH = 0.25  # a secant succeeds if it reduces the function's value to less than this part
SHORT = 0.02  # step back after a secant beyond the zero, as a part of the bracket
MOST = 100  # largest number of evaluations


@dataclass
class Side:
    """Points with one sign of f: their number, the last but one (xa, fa), and the last one (xb, fb)."""

    points: int = 0
    xa: float = math.nan
    fa: float = math.nan
    xb: float = math.nan
    fb: float = math.nan


@dataclass
class Bracket:
    """A bracket [x1, x2] of a zero of f.

    Parameters
    ----------
    x1, f1, p1, x2, f2, p2 : float
        The ends, f there, and another number that belongs to each end (its parameter value); f1 and f2 have opposite signs, or one is zero.
    tolerance : float
        Width of the final bracket relative to the first one.
    jump : float
        Stop if f still changes by more than this over a small part of the first bracket: f has a jump there.
    """

    x1: float
    f1: float
    p1: float
    x2: float
    f2: float
    p2: float
    tolerance: float
    jump: float
    count: int = 0
    failed: bool = False  # whether the last evaluation failed
    wait: int = BISECTIONS  # number of bisections before the next secant
    aimed: int | None = None  # the side whose secant gave the last point
    overshot: bool = False  # whether a secant has ended beyond the zero
    sides: tuple[Side, Side] = field(default_factory=lambda: (Side(), Side()))

    def __post_init__(self) -> None:
        self.x3, self.f3, self.width = self.x1, self.f1, abs(self.x1 - self.x2)

    @property
    def best(self) -> float:
        """The end with the smaller value."""
        return self.x1 if abs(self.f1) < abs(self.f2) else self.x2

    def narrow(self, f: Callable[[float], tuple[float, float]]) -> float:
        """Narrow the bracket; f(x) returns its value and the other number of x. Returns the last point that was evaluated, NaN if none was."""
        if self.f1 == 0.0 or self.f2 == 0.0:  # one end is the root itself
            if self.f2 == 0.0:
                self.x1, self.f1, self.p1 = self.x2, self.f2, self.p2
            else:
                self.x2, self.f2, self.p2 = self.x1, self.f1, self.p1
            return math.nan
        x, ahead = math.nan, self.x1 + 0.5 * (self.x2 - self.x1)
        while ahead == ahead:
            x, ahead = ahead, self.follow(ahead, *f(ahead))
        return x

    def follow(self, x: float, fx: float, px: float) -> float:
        """Add the value f(x), and return the next point to evaluate; NaN at the end.

        If f cannot be evaluated, another point is tried, once.
        """
        if not math.isfinite(fx):
            if self.failed:
                return math.nan
            self.failed = True
            return self.x1 + 0.37 * (self.x2 - self.x1)
        self.failed = False
        self.count += 1
        self._add(x, fx)
        if (fx > 0.0) == (self.f1 > 0.0):
            self.x3, self.f3 = self.x1, self.f1
        else:
            self.x3, self.f3 = self.x2, self.f2
            self.x2, self.f2, self.p2 = self.x1, self.f1, self.p1
        self.x1, self.f1, self.p1 = x, fx, px
        x1, f1, x2, f2, x3, f3 = x, fx, self.x2, self.f2, self.x3, self.f3
        if f1 == 0.0:
            self.x2, self.f2, self.p2 = x1, f1, px
            return math.nan
        limit = 0.5 * self.tolerance * self.width / max(abs(x2 - x1), TINY)
        if abs(f1 - f2) > self.jump and abs(x2 - x1) < SOLUTION.jump * self.width:
            return math.nan
        if limit > 0.5 or abs(x2 - x1) <= self.tolerance * self.width or self.count >= MOST:
            return math.nan
        xi = (x1 - x2) / (x3 - x2)
        phi = (f1 - f2) / (f3 - f2) if f3 != f2 else 2.0
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            t = (f1 / (f2 - f1)) * (f3 / (f2 - f3)) + ((x3 - x1) / (x2 - x1)) * (f1 / (f3 - f1)) * (
                f2 / (f3 - f2)
            )
        else:
            t = (self._ahead() - x1) / (x2 - x1)
        return x1 + min(1.0 - limit, max(limit, t)) * (x2 - x1)

    def _add(self, x: float, fx: float) -> None:
        """Add a point to its side, and judge the secant that gave it: after one that reduced f too little, bisections follow."""
        positive = int(fx > 0.0)
        side, aimed = self.sides[positive], self.aimed
        if aimed is not None and aimed != positive:
            self.overshot = True
        elif aimed is not None and not abs(fx) < ENOUGH * abs(side.fb):
            self.wait = BISECTIONS  # f is not smooth enough
        side.points += 1
        side.xa, side.fa, side.xb, side.fb = side.xb, side.fb, x, fx
        self.aimed = None

    def _ahead(self) -> float:
        """Return the next point if an inverse quadratic step is not safe: from a secant on one side, or the middle."""
        x1, x2 = self.x1, self.x2
        if self.overshot:  # a secant ended just beyond the zero: step back a little
            self.overshot, self.wait = False, 0
            return x1 + SHORT * (x2 - x1)
        nearest, position = math.inf, 0.5 * (x1 + x2)
        if self.wait > 0:
            self.wait -= 1
            return position
        for index, side in enumerate(self.sides):
            if side.points < 2 or not abs(side.fb) < abs(side.fa):
                continue
            step = side.fb * (side.xb - side.xa) / (side.fa - side.fb)
            if abs(step) < nearest and min(x1, x2) < side.xb + step < max(x1, x2):
                nearest, position, self.aimed = abs(step), side.xb + step, index
        return position
