"""Multipliers past the circle: period doublings, Neimark-Sacker and Hopf points, and folds and branch points where they show there.

Multipliers are taken one by one (:func:`contvines.continuation.layout.multiplier`): the k-th largest real one is a test function of its own, so
two that cross at once are two events. A product of test functions would not change sign.
"""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine
from .settings import LOCATING


def sizes_by_sort(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """How far past the circle multipliers are, shape (3, ..., m): real ones near 1, near -1, and complex pairs; NaN where they are of another sort.

    As logarithms; for flows real parts (there is nothing near -1). Where only branch points are looked for ("real") all count as real, so
    that a double one, which rounding makes a pair or two, counts twice either way.
    """
    re, im, kind = rows[..., : 2 * engine.m : 2], rows[..., 1 : 2 * engine.m : 2], engine.detection
    with np.errstate(all="ignore"):
        real = im == 0.0
        if kind == "map":
            size = np.log(np.where(real | np.isnan(re), np.abs(re), np.hypot(re, im)))
            sorts = real & (re > 0.0), real & (re <= 0.0), im > 0.0
        else:
            size, none = re, np.zeros_like(real)
            sorts = (
                (real, none, im > 0.0) if kind == "flow" else (np.full_like(real, kind == "real"), none, none)
            )
        return np.where(np.array(sorts), size, np.nan)


def counts(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """How many multipliers are past the circle: real ones past 1, past -1, and complex pairs; shape (..., 3)."""
    return np.moveaxis((sizes_by_sort(engine, rows) > LOCATING.past).sum(axis=-1), 0, -1)


def balance(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Smallest number past the circle plus the largest before it, of the real multipliers of each row; 0 without both.

    Where one multiplier leaves while another enters at the same place, as at branch points with the symmetry of a triangle, no
    count changes, but this sum passes through zero.
    """
    size = sizes_by_sort(engine, rows)[0]
    past = np.where(size > 0.0, size, np.inf).min(axis=-1, initial=np.inf)
    before = np.where(size <= 0.0, size, -np.inf).max(axis=-1, initial=-np.inf)
    both = np.isfinite(past) & np.isfinite(before)
    return np.where(both, np.where(both, past, 0.0) + np.where(both, before, 0.0), 0.0)


def pairs_past(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Of eigenvalues that all count as real ones ("real"), how many are past the axis in pairs that rounding has not made; shape (...)."""
    re, im = rows[..., : 2 * engine.m : 2], np.abs(rows[..., 1 : 2 * engine.m : 2])
    unit = np.minimum(np.hypot(re, im).max(axis=-1, keepdims=True, initial=0.0), 1.0)
    return ((re > LOCATING.past) & (im > engine.settings.critical * unit)).sum(axis=-1)
