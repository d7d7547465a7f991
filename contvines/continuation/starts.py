"""Checking what a run begins with."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .engine import Engine, Solved


def check_interval(within: Any) -> tuple[float, float]:
    """The interval as two floats.

    Raises
    ------
    ValueError
        If it is not two finite numbers, the first one smaller.
    """
    try:
        lower, upper = (float(value) for value in within)
    except (TypeError, ValueError):
        raise ValueError(
            f"within = {within!r} must be two numbers, the ends of the parameter interval"
        ) from None
    if not (math.isfinite(lower) and math.isfinite(upper)):
        raise ValueError(f"within = [{lower}, {upper}] must have finite ends")
    if not lower < upper:
        raise ValueError(
            f"within = [{lower}, {upper}] is empty or reversed; the first end must be the smaller one"
        )
    return lower, upper


def solve_start(engine: Engine, u: Any, p: float, tangent: np.ndarray | None = None) -> Solved:
    """The first point of a branch.

    Raises
    ------
    ValueError
        If the start lies outside the interval or Newton's method does not converge from it.
    """
    name = engine.problem.parameter
    u = np.asarray(u, dtype=float).reshape(-1)
    p = float(p)
    if not engine.lower <= p <= engine.upper:
        raise ValueError(
            f"the start {name} = {p:.10g} lies outside of within = [{engine.lower:.10g}, {engine.upper:.10g}]; "
            "widen the interval or move the start"
        )
    if len(u) != engine.n or not np.all(np.isfinite(u)):
        raise ValueError(f"the start must be {engine.n} finite numbers, not {u}")
    found = engine.start(u, p, tangent)
    if found is None:
        residual = engine.residual(u, p)
        raise ValueError(
            f"the start at {name} = {p:.10g} does not converge (its residual is {residual:.3g}); "
            "give a better guess or another parameter value"
        )
    return found
