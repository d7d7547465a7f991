"""Collocation equations from values at the Gauss points: in the native core, or in numpy, which says what is computed."""

from __future__ import annotations

import numpy as np

from ..core.library import NOTHING, POINTER, WHOLE, function, native
from ..core.records import place
from .collocation import Rule
from .mesh import closed


def at_gauss_points(rule: Rule, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The polynomials and their derivatives (by the place in the interval, 0 to 1) at the Gauss points, both of shape (N m, d).

    Parameters
    ----------
    rule : Rule
    x : ndarray, shape (N, m, d)
        Values at the nodes of each interval, without the last one.
    """
    count, m, d = x.shape
    if not native():
        ends = closed(x)
        points = np.einsum("cj,ijk->ick", rule.values, ends).reshape(-1, d)
        return points, np.einsum("cj,ijk->ick", rule.slopes, ends).reshape(-1, d)
    x = np.ascontiguousarray(x, dtype=float)
    points, slopes = np.empty((2, count * m, d))
    call = function("core_at_gauss_points", NOTHING, *[POINTER] * 3, *[WHOLE] * 3, *[POINTER] * 2)
    call(place(rule.values), place(rule.slopes), place(x), count, m, d, place(points), place(slopes))
    return points, slopes


def blocks_of(rule: Rule, steps: np.ndarray, jacobian: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Derivatives of ``x' - step f(x)`` at the Gauss points of each interval by the values at its nodes, shape (N, m d, (m + 1) d).

    Parameters
    ----------
    rule : Rule
    steps : ndarray, shape (N,)
        Widths of the intervals in time.
    jacobian : ndarray, shape (N m, d, d)
        df/dx at the Gauss points.
    scale : ndarray, shape (d,)
        Unknowns and equations are counted in it.
    """
    count, m, d = len(steps), rule.degree, len(scale)
    if not native():
        scaled = jacobian.reshape(count, m, d, d) * (scale / scale[:, None])
        blocks = np.einsum("cj,icab->icajb", rule.values, -steps[:, None, None, None] * scaled)
        diagonal = np.arange(d)
        blocks[:, :, diagonal, :, diagonal] += rule.slopes
        return blocks.reshape(count, m * d, (m + 1) * d)
    blocks = np.empty((count, m * d, (m + 1) * d))
    arrays = [np.ascontiguousarray(array, dtype=float) for array in (steps, jacobian, scale)]
    call = function("core_collocation_blocks", NOTHING, *[POINTER] * 5, *[WHOLE] * 3, POINTER)
    call(place(rule.values), place(rule.slopes), *map(place, arrays), count, m, d, place(blocks))
    return blocks
