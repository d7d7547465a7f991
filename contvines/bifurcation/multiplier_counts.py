"""Numbers of multipliers past the circle: period doublings, Neimark-Sacker and Hopf points, and folds and branch points where they show there.

Multipliers are taken one by one (:func:`contvines.continuation.aims.multiplier`): the k-th largest real one is a test function of its own, so
two that cross at once are two events. A product of test functions would not change sign.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..continuation.aims import LIMIT
from ..continuation.engine import Engine, Solved

PAST = 1e-10  # multipliers of a conservative system lie on the circle up to roundoff: that is no crossing


def counts(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """How many multipliers are past the circle: real > 1, real < -1, complex pairs outside; shape (n, 3).

    For flows: real eigenvalues > 0, nothing, complex pairs with positive real part. Where only branch points are looked for
    ("real"): eigenvalues with positive real part, so that a double one, which rounding makes a pair or two, counts twice either way.
    """
    result = np.zeros((len(spectrum), 3), dtype=np.int64)
    real = spectrum.imag == 0.0
    upper = spectrum.imag > 0.0
    if kind == "map":
        columns = (
            real & (spectrum.real > 1.0 + PAST),
            real & (spectrum.real < -1.0 - PAST),
            upper & (np.abs(spectrum) > 1.0 + PAST),
        )
    elif kind == "real":
        columns = (spectrum.real > PAST,)
    elif kind == "flow":
        columns = (real & (spectrum.real > PAST), np.zeros_like(real), upper & (spectrum.real > PAST))
    else:
        return result
    for place, past in enumerate(columns):
        for j in range(past.shape[1]):  # few columns, many rows
            result[:, place] += past[:, j]
    return result


def counts_at(numbers: Sequence[float], kind: str) -> list[int]:
    """The `counts` of one point, of few multipliers as re, im in turns: Python is faster than numpy."""
    plus, minus, pairs = 0, 0, 0
    edge = 1.0 + PAST if kind == "map" else PAST
    for re, im in zip(numbers[::2], numbers[1::2]):
        if im == 0.0 or kind == "real":
            plus += re > edge
            minus += kind == "map" and re < -edge
        elif im > 0.0:
            pairs += (math.hypot(re, im) if kind == "map" else re) > edge
    return [plus, minus, pairs] if kind != "none" else [0, 0, 0]


def counts_of(engine: Engine, point: Solved) -> list[int]:
    """The `counts` of one solved point."""
    return counts_at(point.row[: 2 * engine.m].tolist(), engine.detection)


def balance(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """Smallest number past the circle plus the largest before it, of the real multipliers of each row; NaN without both.

    Where one multiplier leaves while another enters at the same place, as at branch points with the symmetry of a triangle, no
    count changes, but this sum passes through zero.
    """
    real = np.where(spectrum.imag == 0.0, spectrum.real, np.nan)
    if kind == "map":
        with np.errstate(all="ignore"):
            real = np.where(real > 0.0, np.log(real), np.nan)
    past = np.where(real > 0.0, real, np.inf).min(axis=-1, initial=np.inf)
    before = np.where(real <= 0.0, real, -np.inf).max(axis=-1, initial=-np.inf)
    both = np.isfinite(past) & np.isfinite(before)
    return np.where(both, np.where(both, past, 0.0) + np.where(both, before, 0.0), np.nan)


def nearest_to_circle(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """Distance from the circle (the axis) of the nearest real positive multiplier of each row, as a logarithm; clipped at LIMIT."""
    real = np.where(spectrum.imag == 0.0, spectrum.real, np.nan)
    if kind == "map":
        with np.errstate(all="ignore"):
            real = np.where(real > 0.0, np.log(real), np.nan)
    return np.nan_to_num(np.fmin.reduce(np.abs(real), axis=-1, initial=LIMIT), nan=LIMIT)
