"""Cycles that stand for homoclinic orbits, with another period."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine
from ..continuation.settings import Settings
from ..flows.cycles import CycleProblem
from ..flows.infinite_period import InfinitePeriod, infinite_period
from .on_mesh import on_mesh

LONGER = 1.3  # factor from one period to the next, on the way to a longer one
LEFT = 0.1  # part of its time that an interval beside a saddle keeps at least, on the way to a shorter period


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
    wanted = float(u[problem.period_place])
    while wanted != period:  # what is found has the wanted period but for rounding
        wanted = min(max(period, wanted / LONGER), wanted * LONGER)
        found = of_period(problem, _waiting(problem, u, p, wanted), p, wanted)
        if found is None:
            raise ValueError(
                f"period = {period:.6g}: on the way there no cycle of period {wanted:.6g} is found beyond the one of {u[problem.period_place]:.6g}"
            )
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


def with_suited_period(point: SpecialPoint) -> SpecialPoint:
    """A homoclinic end as its locus begins, with a shorter period where there are several saddles; any other point as it is.

    One parameter brings a cycle as near to one saddle as is wanted. To several of them it comes no nearer than the error of its mesh is, and with a
    longer period no cycle is found further on.
    """
    if point.kind != "homoclinic":
        return point
    problem, u, p = on_mesh(point.attached), np.array(point.u), float(point.value)
    limit = infinite_period(problem, point)
    if len(limit.saddles) < 2:
        return point
    rates = [float(np.abs(np.real(saddle.eigenvalues)).min()) for saddle in limit.saddles]
    period = -math.log(problem.flow.settings.error) * sum(1.0 / rate for rate in rates)
    try:
        problem, u, p = lengthened(problem, u, p, min(period, limit.period))
    except ValueError:
        return point
    return replace(point, problem=problem, u=u, value=p)


def limit_of(problem: CycleProblem, u: np.ndarray, p: float) -> InfinitePeriod | None:
    """What a cycle of a long period becomes as it grows without bound; None where its branch cannot be followed."""
    border = np.zeros(problem.dimension + 1)
    border[problem.period_place] = 1.0
    width = 1.0 + abs(p)
    period = float(u[problem.period_place])
    found = Engine(problem, (p - width, p + width), Settings()).solve(u, p, border, period)
    if found is None:
        return None
    about = "", "homoclinic", "", found.p, problem.parameter
    return infinite_period(problem, SpecialPoint(*about, found.u, found.tangent, np.zeros(0)))


def _waiting(problem: CycleProblem, u: np.ndarray, p: float, period: float) -> np.ndarray:
    """A guess of a cycle of another period: it waits longer, or less long, at each of its saddles."""
    limit = limit_of(problem, u, p)
    if limit is None or len(limit.saddles) < 2:
        return problem.waiting(u, p, period)
    x, now, widths = problem.parts(u, p)
    times, total = now * widths, sum(saddle.share for saddle in limit.saddles)
    for saddle in limit.saddles:
        more = (period - now) * saddle.share / total
        away = np.abs((x[:, 0] - saddle.place) / problem.node_scale).max(axis=1)
        for i in np.argsort(np.maximum(away, np.roll(away, -1))):
            change = max(more, (LEFT - 1.0) * times[i])
            times[i] += change
            more -= change
            if not more:
                break
    return problem.joined(x, period, times / times.sum())
