"""Sides of a border in the plane of two parameters."""

from __future__ import annotations

import numpy as np

from ..branches.branch import Branch
from ..shared.floating_point import TINY
from .linear import Linearisation
from .problem import LocusProblem
from .settings import SCALING, VANISHING


def impossible_side(problem: LocusProblem, branch: Branch) -> int:
    """On which side of a border, in the plane (q, p), its margin is negative."""
    i = len(branch) // 2
    at = problem.at(float(branch.values[i]))
    u, p = problem.split(branch.points[i])
    p = float(p)
    line = Linearisation(at)
    place = 2 * int(at.n_multipliers) + problem.index
    line.at(u, p)
    start = line.row()[place]
    null = line.null_vectors()
    if abs(null.test) < VANISHING.singular:
        return 0
    b, c = null.column, null.row
    x, s = line.solve(-line.slope, b, c)
    v, g = line.null(b, c)
    direction = x - (s / g) * v  # du/dp along the motions themselves
    sizes = problem.sizes_at(u, p, float(branch.values[i]))
    step = SCALING.step * min(
        float(sizes[-2]), 1.0 / max(float((np.abs(direction) / sizes[:-2]).max()), TINY)
    )
    line.at(u + step * direction, p + step)
    rise = line.row()[place] - start
    along = branch.tangents[i]
    if not np.isfinite(rise) or rise == 0.0:
        return 0
    up_is_left = along[-1] > 0.0  # going to the right, larger p is on the left
    return (-1 if up_is_left else 1) if rise > 0.0 else (1 if up_is_left else -1)
