"""Kinks and jumps: why Newton's method fails where equations are not smooth."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .settings import DERIVATIVES

POINTS = 24  # on the line, each time it is looked at more closely
ROUNDS = 7
NOISY = 20.0  # times the noise, second differences say nothing


class Break(NamedTuple):
    """A place on a line where a function is not smooth: ``kind`` is "kink" or "jump", ``row`` the entry that is worst."""

    kind: str
    at: float
    row: int


def find_break(
    f: Callable[[float], np.ndarray], length: float, rows: np.ndarray, noise: float | np.ndarray = 0.0
) -> Break | None:
    """The sharpest kink or jump of f between -length and length, or None.

    The function is sampled, and looked at again where its second difference is largest. In the end the slopes on both sides differ
    at a kink as they did from afar, and at a jump so do the values; a smooth function has become straight.

    Parameters
    ----------
    f : callable
        t -> ndarray of shape (n,); not finite where it cannot be evaluated.
    length : float
    rows : ndarray, shape (n,)
        How much the entries change when t changes by 1, roughly.
    noise : float or ndarray
        Standard deviation of f: what is no larger than a few of it is neither kink nor jump.
    """
    low, high, t, values, k, step = -length, length, np.zeros(0), rows, 0, 0.0
    for _ in range(ROUNDS):
        t = np.linspace(low, high, POINTS + 1)
        values = np.array([f(x) for x in t]) / rows
        if not np.isfinite(values).all():
            return None
        second = np.abs(np.diff(values, 2, axis=0)).max(axis=1)
        if second.max() < NOISY * float(np.max(noise / rows)):
            return None
        k = int(np.argmax(second)) + 1
        step = float(t[1] - t[0])
        low, high = t[max(k - 2, 0)], t[min(k + 2, POINTS)]
    if step < DERIVATIVES.roundoff * max(abs(low), abs(high)):
        return None
    left, right = values[max(k - 3, 0)], values[min(k + 3, POINTS)]
    if k < 4 or k > POINTS - 4:
        return None
    before = (values[k - 2] - left) / (t[k - 2] - t[max(k - 3, 0)])
    after = (right - values[k + 2]) / (t[min(k + 3, POINTS)] - t[k + 2])
    leap = np.abs(values[k + 2] - values[k - 2]) - 4.0 * step * np.maximum(np.abs(before), np.abs(after))
    row = int(np.argmax(leap))
    if leap[row] > DERIVATIVES.leap:
        return Break("jump", float(t[k]), row)
    bend = np.abs(after - before)
    row = int(np.argmax(bend))
    return Break("kink", float(t[k]), row) if bend[row] > DERIVATIVES.kink else None
