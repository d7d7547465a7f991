"""When a motion has settled."""

from __future__ import annotations

import math

import numpy as np

BAND = 0.05  # share of its last size within which a response has settled


def settled(times: np.ndarray, motion: np.ndarray, periods: int) -> float:
    """From when on the largest displacement of every period is close to that of the last quarter; nan if that is not even.

    Parameters
    ----------
    times, motion : float array (n,)
        Evenly spaced over so many `periods`, from time 0.
    periods : int
    """
    sizes = np.array([np.abs(part).max() for part in np.array_split(motion, periods)])
    last = sizes[-max(1, periods // 4) :]
    off = np.abs(sizes - last.mean()) > BAND * last.mean()
    if off[-len(last) :].any():
        return math.nan
    first = int(np.flatnonzero(off)[-1]) + 1 if off.any() else 0
    return float(times[-1] * first / periods)
