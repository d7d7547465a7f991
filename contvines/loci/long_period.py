"""Cycles that stand for homoclinic orbits, with another period."""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem

LONGER = 1.3  # factor from one period to the next, on the way to a longer one


def lengthened(
    problem: CycleProblem, u: np.ndarray, p: float, period: float
) -> tuple[CycleProblem, np.ndarray, float]:
    """A nearly homoclinic cycle with another period.

    Where it is longer the cycle waits at its slowest point.

    Raises
    ------
    ValueError
        If the period is not positive, or no such cycle is found.
    """
    if not period > 0.0:
        raise ValueError(f"period = {period!r} must be positive")
    while (now := float(u[problem.period_place])) != period:
        wanted = min(max(period, now / LONGER), now * LONGER)
        found = of_period(problem, problem.waiting(u, p, wanted), p, wanted)
        if found is None:
            raise ValueError(f"no cycle of period {wanted:.6g} is found beyond the one of {now:.6g}")
        problem, u, p = found
    return problem, u, p


def of_period(
    problem: CycleProblem, u: np.ndarray, p: float, period: float
) -> tuple[CycleProblem, np.ndarray, float] | None:
    """The cycle of a given period near a guess, on a mesh that suits it."""
    while True:
        border = np.zeros(problem.dimension + 1)
        border[problem.period_place] = 1.0
        width = 1.0 + abs(p)
        engine = Engine(problem, (p - width, p + width), Settings())
        found = engine.solve(u, p, border, period)
        if found is None:
            return None
        image = problem.adapted(found.u)
        if image is not None:
            u, p = image(found.u), found.p
            again = engine.solve(u, p, border, period)
            found = found if again is None else again
        if not problem.too_coarse(found.u, found.p):
            return problem, found.u, found.p
        u, p = problem.halved(found.u), found.p
        problem = problem.with_unknowns(u, p, 2 * problem.intervals, problem.copies)
