"""What invariant circles ask of a problem: its motion seen once per period, by simulation.

The contract, in words:

1. ``problem.section(p)`` returns a section of the motions at a parameter value; it knows no equations of cycles.
2. ``section.names`` are its coordinates.
3. ``section.through(u)`` is the point in which the motion that begins with the unknowns u meets the section, shape (d,). It is
   smooth in u; of a cycle, it is a fixed point of ``step``.
4. ``section.rounds(u)`` are the points in which the cycle itself meets the section, shape (periods, d), the first that of ``through``.
5. ``section.step(x)`` is the next point, one period of the cycle later, shape (d,); NaN where the motion does not come back.
6. ``section.varied(x)``, where a section has it: the next point with its derivatives by x, shape (d, d), and by the parameter, shape
   (d,); NaN where they are not known. Without it differences of ``step`` stand in.
   ``section.images(points)`` does that of many points at once; of flows it is the map of which the cycle is a fixed point exactly, while ``step``
   is a simulation. ``section.returns_watched`` are the returns of a simulation at most, where each takes long.
7. ``section.struck(x, near)``, where a section has it: of a point at a wall, or no farther from it than `near`, the other point there from
   which the motion goes on alike (just before and just after an impact), and the direction away from the wall; None elsewhere.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from ..problems.abilities import Section as Section
from ..problems.abilities import Sectioned
from ..problems.protocol import Problem


@runtime_checkable
class Varied(Protocol):
    """A section that knows the derivatives of its steps."""

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


@runtime_checkable
class Imaged(Protocol):
    """A section that knows the steps of many points, with their derivatives."""

    def images(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...

    def length(self, direction: np.ndarray) -> float: ...


@runtime_checkable
class Watched(Protocol):
    """A section whose steps take so long that a simulation is followed for so many returns at most."""

    returns_watched: int


@runtime_checkable
class Walled(Protocol):
    """A section that knows the walls at which motions rebound."""

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None: ...


def section_of(problem: Problem, p: float) -> Section:
    """The section of a problem.

    Raises
    ------
    ValueError
        If its motions cannot be simulated.
    """
    if not isinstance(problem, Sectioned) or problem.spectrum != "map":
        raise ValueError(
            f"{type(problem).__name__} has no motions that can be simulated period by period, so no circles; maps, machines and flows have"
        )
    return problem.section(p)


def slopes(section: Section, x: np.ndarray, size: float) -> np.ndarray:
    """Derivative of ``step`` at a point, shape (d, d), by central differences.

    Parameters
    ----------
    section : Section
    x : ndarray, shape (d,)
    size : float
        Length of the differences.
    """
    result = np.empty((len(x), len(x)))
    for j in range(len(x)):
        moved = np.zeros(len(x))
        moved[j] = size
        result[:, j] = (section.step(x + moved) - section.step(x - moved)) / (2.0 * size)
    return result
