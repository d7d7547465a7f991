"""Bordered block-cyclic linear systems with blocks of any size, solved in O(N) by orthogonal elimination in the native core
(`native/collocation.hpp`)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .library import NUMBER, POINTER, WHOLE, address, function
from .table import pack


class Eliminated(NamedTuple):
    """Solution of a block-cyclic system.

    Its fields in order: values at the nodes, shape (N, m d, s); shared unknowns, shape (k, s); the two blocks of the equations between
    neighbouring mesh points after elimination, each of shape (N, d, d); sign of the determinant.
    """

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
    """Solve ``blocks[i] x_i + columns[i] (e, -1) = 0`` and ``sum rows[i] x_i + foot (e, -1) = 0`` for the node values x and the shared unknowns e.

    The last node of an interval is the first one of the next, and the last node of all is ``closure`` times the first.

    Parameters
    ----------
    blocks : ndarray, shape (N, m d, (m + 1) d)
        m is the number of nodes per interval; m = 1: equations between neighbouring nodes.
    columns : ndarray, shape (N, m d, k + s)
        Columns of the k shared unknowns, then s right-hand sides.
    rows : ndarray, shape (N, k, m d)
        Border rows.
    foot : ndarray, shape (k, k + s)
        Corner of the border, then its right-hand sides.
    d : int
        Number of states at a node.
    closure : float
        1 for periodic solutions, -1 for antiperiodic ones.
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
