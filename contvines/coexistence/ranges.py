"""The interval of a parameter, the others fixed, in which a motion stays stable and real."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..branches.branch import Branch, Reason
from ..continuation.starts import problem_and_start
from ..graph.automatic import diagram
from ..problems.maps import MapProblem

if TYPE_CHECKING:
    from ..problems.protocol import Problem

REACH = 0.5  # of a parameter's size, to either side
HALVINGS = 12  # of an end of the interval that the machine refuses
AT_THE_MOTION = {
    Reason.BORDER,
    Reason.LEAVES,
    Reason.GOES_ON,
    Reason.REACHES,
    Reason.MEETS,
    Reason.MEETS_SYMMETRIC,
    Reason.COMES_BACK,
    Reason.STOPS,
}


@dataclass(frozen=True)
class StableRange:
    """Interval of a parameter in which a motion is known to be stable and real.

    Attributes
    ----------
    ends : (float, float)
    lost : (bool, bool)
        For either end, whether the motion loses its stability or ceases to be real there. False: the search ended there.
    """

    ends: tuple[float, float]
    lost: tuple[bool, bool]


def stable_range(problem: Problem, u: np.ndarray, p: float, name: str) -> StableRange:
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
    if isinstance(problem, MapProblem):
        seed = problem.cycle_through(problem.section(p).rounds(u), p)
        if name != problem.parameter:
            seed = seed.against(name)
    else:
        seed = problem.orbit(u, p)
    other, _, value = problem_and_start(seed, name)
    low, high = (_allowed(other, name, value, side * REACH * (abs(value) or 1.0)) for side in (-1.0, 1.0))
    graph = diagram(seed, over=name, within=(low, high), depth=0)
    first, last, lost = value, value, [False, False]
    for branch in graph.branches.values():
        if branch.real:
            for a, b in branch.stable_intervals():
                if a <= value <= b:
                    if a < first:
                        first, lost[0] = a, not _search_ended(branch, a)
                    if b > last:
                        last, lost[1] = b, not _search_ended(branch, b)
    return StableRange((first, last), (lost[0], lost[1]))


def _search_ended(branch: Branch, value: float) -> bool:
    """Whether a branch ends at a value for a reason that lies in the continuation, not in the motion."""
    ends = zip((branch.values[0], branch.values[-1]), branch.endings)
    return not branch.closed and any(
        end == value and ending.reason not in AT_THE_MOTION for end, ending in ends
    )


def _allowed(problem: Problem, name: str, value: float, change: float) -> float:
    """The value changed, by less where the machine refuses it."""
    for _ in range(HALVINGS):
        try:
            problem.check_value(name, value + change)
            return value + change
        except ValueError:
            change *= 0.5
    return value + change
