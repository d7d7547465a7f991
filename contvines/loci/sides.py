"""Sides of a border in the plane of two parameters."""

from __future__ import annotations

import numpy as np

from ..branches.branch import Branch
from .linear import Linearisation
from .problem import LocusProblem


def impossible_side(problem: LocusProblem, branch: Branch) -> int:
    """On which side of a border, in the plane (q, p), its margin is negative."""
    i, n = len(branch) // 2, problem.size
    at = problem.at(float(branch.values[i]))
    u, p = branch.points[i, :n], float(branch.points[i, n])
    line = Linearisation(at)
    place = 2 * int(at.n_multipliers) + problem.index
    line.at(u, p)
    start = line.row()[place]
    step = 1e-6 * (1.0 + abs(p))
    null = line.null_vectors()
    b, c = null.left, null.right
    x, s = line.solve(-line.slope, b, c)
    v, g = line.null(b, c)
    if g == 0.0:
        return 0
    direction = x - (s / g) * v  # du/dp along the motions themselves
    line.at(u + step * direction, p + step)
    rise = line.row()[place] - start
    along = branch.tangents[i]
    if not np.isfinite(rise) or rise == 0.0:
        return 0
    up_is_left = along[-1] > 0.0  # going to the right, larger p is on the left
    return (-1 if up_is_left else 1) if rise > 0.0 else (1 if up_is_left else -1)
