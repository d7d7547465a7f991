"""Block-cyclic systems with border, of blocks of any size, in O(N): orthogonal elimination by the native core (`native/collocation.hpp`)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .library import NUMBER, POINTER, WHOLE, address, function
from .table import pack


class Eliminated(NamedTuple):
    """Values at the nodes, shape (N, m d, s), shared unknowns, (k, s), equations between mesh points, both (N, d, d), sign of the determinant."""

    states: np.ndarray
    shared: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sign: float


def eliminate(
    blocks: np.ndarray,
    columns: np.ndarray,
    rows: np.ndarray,
    foot: np.ndarray,
    d: int,
    closure: float = 1.0,
) -> Eliminated:
    """Solve ``blocks[i] x_i + columns[i] (e, -1) = 0``, ``sum rows[i] x_i + foot (e, -1) = 0``, where the last node of an interval is the
    first one of the next, and the last one of all is ``closure`` times the first.

    Parameters
    ----------
    blocks : ndarray, shape (N, m d, (m + 1) d)
        m = 1: equations between neighbouring nodes.
    columns : ndarray, shape (N, m d, k + s)
        Of the k shared unknowns, then s right-hand sides.
    rows : ndarray, shape (N, k, m d)
    foot : ndarray, shape (k, k + s)
    d : int
    closure : float
    """
    count, size, _ = blocks.shape
    k, s = foot.shape[0], foot.shape[1] - foot.shape[0]
    arrays = [np.ascontiguousarray(array, dtype=float) for array in (blocks, columns, rows, foot)]
    left, right = np.empty((2, count, d, d))
    states, shared, room = (
        np.empty((count, size, s)),
        np.empty((k, s)),
        np.empty(_room(count, size - d, d, k, s)),
    )
    system = pack(count, size - d, d, k, s, float(closure), *arrays, left, right, states, shared, room)
    sign = function("core_collocation", NUMBER, POINTER)(address(system))
    return Eliminated(states, shared, left, right, sign)


@lru_cache(maxsize=64)
def _room(*sizes: int) -> int:
    return function("core_collocation_room", WHOLE, *[WHOLE] * 5)(*sizes)
