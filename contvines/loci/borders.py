"""Borders of the bordered systems of a locus, at one of its points."""

from __future__ import annotations

import numpy as np

from ..problems.protocol import Problem
from .layout import BRANCH, FLIP, FOLD
from .linear import Linearisation, Null


def fresh_borders(size: int) -> np.ndarray:
    """Borders without a pattern, shape (4, size + 1)."""
    return np.random.default_rng(5).standard_normal((4, size + 1)) / np.sqrt(size)


def borders_at(
    problem: Problem, wanted: int, u: np.ndarray, p: float, near: np.ndarray | None = None
) -> np.ndarray:
    """Borders that belong to a point: null vectors of the matrix that is singular there.

    Parameters
    ----------
    problem : Problem
    wanted : int
        The condition that is followed; see :mod:`contvines.loci.layout`.
    u, p
        The point.
    near : ndarray, optional
        Borders of a neighbour, whose orientation is kept: the sign of the determinant depends on it.
    """
    line = Linearisation(problem)
    line.at(u, p)
    n = line.size
    borders = fresh_borders(n) if near is None else near.copy()
    if near is not None and wanted not in (FOLD, BRANCH, FLIP):
        return borders
    null = line.null_vectors(near=_pair(near, 0))
    if wanted in (FOLD, BRANCH):
        borders[0, :n], borders[1, :n] = null.column, null.row
    elif near is None:  # a regular matrix: any borders that are not special
        b = line.rows * (np.random.default_rng(6).standard_normal(n) / np.sqrt(n))
        v, _ = line.null(b, null.row)
        borders[0, :n], borders[1, :n] = b, line.border_of(v)
    if wanted == FLIP:
        null = line.null_vectors(True, _pair(near, 2))
        borders[2, :n], borders[3, :n] = null.column, null.row
    return borders


def _pair(near: np.ndarray | None, first: int) -> Null | None:
    """Column and row of a neighbour."""
    if near is None:
        return None
    b, c = near[first, :-1], near[first + 1, :-1]
    return Null(c, b, c, 0.0)
