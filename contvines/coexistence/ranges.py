"""The interval of a parameter, the others fixed, in which a motion stays stable and real."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..continuation.starts import problem_and_start
from ..graph.automatic import diagram

REACH = 0.5  # of a parameter's size, to either side
HALVINGS = 12  # of an end of the interval that the machine refuses


def stable_range(problem: Any, u: np.ndarray, p: float, name: str) -> tuple[float, float]:
    """Smallest and largest value of the parameter `name` up to which a motion stays stable and real, within half its size.

    Parameters
    ----------
    problem : Problem
    u, p
        The motion.
    name : str
        A parameter of the problem, its own or another.

    Raises
    ------
    ValueError
        If the problem has no such parameter.
    """
    seed = problem.orbit(u, p)
    if not (hasattr(seed, "problem") and hasattr(seed, "seed")):  # a map's points
        seed = problem.cycle_through(problem.section(p).rounds(u), p)
        if name != problem.parameter:
            seed = seed.against(name)
    other, _, value = problem_and_start(seed, name)
    low, high = (_allowed(other, name, value, side * REACH * (abs(value) or 1.0)) for side in (-1.0, 1.0))
    graph = diagram(seed, over=name, within=(low, high), depth=0)
    ends = [value, value]
    for branch in graph.branches.values():
        if branch.real:
            for first, last in branch.stable_intervals():
                if first <= value <= last:
                    ends = [min(ends[0], first), max(ends[1], last)]
    return ends[0], ends[1]


def _allowed(problem: Any, name: str, value: float, change: float) -> float:
    """The value changed, by less where the machine refuses it."""
    for _ in range(HALVINGS):
        try:
            problem.check_value(name, value + change)
            return value + change
        except ValueError:
            change *= 0.5
    return value + change
