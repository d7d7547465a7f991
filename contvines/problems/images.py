"""Symmetries as users give them: callables, matrices or permutations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def image_map(symmetry: Any, n: int, name: str = "mirror") -> Callable[[np.ndarray], np.ndarray]:
    """u -> image of u.

    Parameters
    ----------
    symmetry : callable, array of shape (n, n), or n whole numbers
        A function, a matrix, or a permutation: the image's entry j is u[symmetry[j]].
    n : int
        Number of unknowns.
    name : str
        For messages.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    if callable(symmetry):
        call: Callable[[np.ndarray], Any] = symmetry
        return lambda u: np.array(call(np.array(u, dtype=float)), dtype=float).reshape(-1)
    matrix = np.asarray(symmetry)
    if matrix.ndim == 1 and len(matrix) == n and np.array_equal(np.sort(matrix), np.arange(n)):
        order = matrix.astype(int)
        return lambda u: np.asarray(u, dtype=float)[order]
    if matrix.shape == (n, n):
        matrix = matrix.astype(float)
        return lambda u: matrix @ u
    raise ValueError(
        f"{name} must be a function of u, a matrix of shape ({n}, {n}) or a permutation of 0 to {n - 1}; "
        f"this one has shape {matrix.shape}"
    )
