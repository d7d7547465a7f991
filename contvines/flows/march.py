"""Many motions of a flow at once: Dormand and Prince's method of order five, each motion with a step length of its own.

Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19, table 2. Importing scipy's takes longer than a diagram of a small flow.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from contvines.shared.floating_point import ROUNDED

from ..problems.functions import NotEvaluable
from .attractors import Place
from .field import Field
from .settings import FlowSettings

FIRST = 0.001  # step at first, in times after which a motion has gone its size
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0
PLACES = (0.2, 0.3, 0.8, 8 / 9, 1.0)
STAGES = [
    np.array([1 / 5]),
    np.array([3 / 40, 9 / 40]),
    np.array([44 / 45, -56 / 15, 32 / 9]),
    np.array([19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729]),
    np.array([9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656]),
]
WHOLE = np.array([35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])
ERROR = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])


class Rates(Protocol):
    """What moves without events: rates of states (n, d) at times."""

    @property
    def forced(self) -> bool: ...
    @property
    def settings(self) -> FlowSettings: ...
    def __call__(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray: ...


class March:
    """Motions that go on from where they are.

    Parameters
    ----------
    field : Field or Rates
    p : float
    x : ndarray, shape (n, d)
    size : ndarray, shape (d,)
        What counts as large in each coordinate.
    """

    def __init__(self, field: Field | Rates, p: float, x: np.ndarray, size: np.ndarray) -> None:
        self.field, self.p, self.size = field, p, size
        self.x, self.t = np.array(x, dtype=float), np.zeros(len(x))
        with np.errstate(all="ignore"):
            self.slope = self._rates(self.x, self.t)
        speed = np.abs(self.slope / size).max(axis=1)
        self.h = FIRST / np.where(np.isfinite(speed) & (speed > 0.0), speed, 1.0)
        self.steps = 0
        self.stopped = np.zeros(len(x), dtype=bool)  # by an event of the flow
        self._stop(np.arange(len(x)))

    def _rates(self, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        field = self.field
        try:
            return np.asarray(field(x, self.p, t if field.forced else None), dtype=float)
        except NotEvaluable:
            return np.array([self._one(y, s) for y, s in zip(x, t, strict=True)])

    def _one(self, x: np.ndarray, t: float) -> np.ndarray:
        try:
            return self.field(x[None], self.p, np.array([t]) if self.field.forced else None)[0]
        except NotEvaluable:
            return np.full(len(x), np.nan)

    def _stop(self, rows: np.ndarray) -> None:
        """Those that are beyond an event become NaN."""
        field = self.field
        if not isinstance(field, Field) or not len(field.events) or not rows.size:
            return
        with np.errstate(all="ignore"):
            beyond = (field.events(self.x[rows], field.values.at(self.p), self.t[rows]) < 0.0).any(axis=1)
        self.stopped[rows[beyond]] = True
        self.x[rows[beyond]] = np.nan

    def go(
        self,
        rows: np.ndarray,
        steps: int,
        until: float = np.inf,
        far: float = np.inf,
        ways: Mapping[int, list[Place]] | None = None,
    ) -> None:
        """Go on with these motions for so many steps, or until a time; what leaves `far` sizes, or fails, becomes NaN.

        The places to which steps lead are added to the ways of motions that have one.
        """
        relative, absolute = self.field.settings.rough_relative, self.field.settings.rough_absolute
        for _ in range(steps):
            rows = rows[np.isfinite(self.x[rows, 0]) & (self.t[rows] < until)]
            if not rows.size:
                return
            x, t, h = self.x[rows], self.t[rows], np.minimum(self.h[rows], until - self.t[rows])
            k = np.empty((7, *x.shape))
            k[0] = self.slope[rows]
            with np.errstate(all="ignore"):
                for s, (place, weights) in enumerate(zip(PLACES, STAGES, strict=True), start=1):
                    k[s] = self._rates(x + h[:, None] * _weighted(weights, k[:s]), t + place * h)
                new = x + h[:, None] * _weighted(WHOLE, k[:6])
                k[6] = self._rates(new, t + h)
                wrong = h[:, None] * _weighted(ERROR, k)
                allowed = absolute * self.size + relative * np.maximum(np.abs(x), np.abs(new))
                error = np.sqrt(np.mean((wrong / allowed) ** 2, axis=1))
                factor = np.clip(SAFETY * error**-0.2, SHRINK, GROW)
            good = error <= 1.0
            took = rows[good]
            self.x[took], self.t[took], self.slope[took] = new[good], (t + h)[good], k[6][good]
            for i, way in (ways or {}).items():
                if good[rows == i].any():
                    way.append(Place(float(self.t[i]), self.x[i].copy(), self.slope[i].copy()))
            self._stop(took)
            whole = h == self.h[rows]
            with np.errstate(all="ignore"):
                scaled = np.where(whole | ~good, h * factor, self.h[rows])
            self.h[rows] = np.where(np.isfinite(error), scaled, SHRINK * h)
            lost = (np.abs(self.x[rows]) > far * self.size).any(axis=1) | (
                h < ROUNDED * np.maximum(1.0, np.abs(t))
            )
            self.x[rows[lost]] = np.nan
            self.steps += len(rows)


def _weighted(weights: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Weighted sum of rates (s, n, d), shape (n, d)."""
    return (weights @ k.reshape(len(k), -1)).reshape(k.shape[1:])
