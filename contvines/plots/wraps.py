"""Curves of angles: where an angle passes the end of its turn, the line is broken, not drawn across the picture."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..branches.branch import Branch


def angles_of(branch: "Branch") -> tuple[str, ...]:
    """Names of the measures of a branch that are angles (radians, modulo 2 pi), as its problem says."""
    return () if branch.problem is None else tuple(branch.problem.angles)


def broken(xs: np.ndarray, ys: np.ndarray, turning: tuple[bool, bool]) -> tuple[np.ndarray, np.ndarray]:
    """A curve with a gap (nan) wherever an angle jumps by more than half a turn between neighbouring points.

    Parameters
    ----------
    xs, ys : float array (n,)
    turning : (bool, bool)
        Whether x and y are angles.

    Returns
    -------
    xs, ys : float array (n + number of jumps,)
    """
    jumps = np.zeros(max(len(xs) - 1, 0), dtype=bool)
    for values, angle in zip((xs, ys), turning):
        if angle:
            jumps |= np.abs(np.diff(values)) > np.pi
    where = np.flatnonzero(jumps) + 1
    return np.insert(xs, where, np.nan), np.insert(ys, where, np.nan)
