"""Section: the protocol that invariant circles require of a problem's motions, seen once per period by simulation.

The contract:

1. ``problem.section(p)`` returns the section of the motions at a parameter value; it does not use the equations of cycles.
2. ``section.names`` are the names of its coordinates.
3. ``section.through(u)`` returns the point in which the motion with the initial unknowns u meets the section, shape (d,). It is
   smooth in u; for a cycle it is a fixed point of ``step``.
4. ``section.rounds(u)`` returns the points in which the cycle meets the section, shape (periods, d); the first is that of ``through``.
5. ``section.step(x)`` returns the next point, one period of the cycle later, shape (d,); NaN if the motion does not return.
6. Optional: ``section.varied(x)`` returns the next point, its derivatives by x, shape (d, d), and by the parameter, shape (d,); NaN for
   unknown derivatives. Without it differences of ``step`` are used. ``section.images(points)`` does the same for many points at once; for flows it
   is the map of which the cycle is exactly a fixed point, while ``step`` is a simulation. ``section.length(direction)`` is the length of a direction
   for normal forms. ``section.returns_watched`` is the most returns of a simulation, if each is expensive.
7. Optional: ``section.struck(x, near)`` returns, for a point at a wall or at most `near` away from it, the other point from which the same motion
   continues (just before and just after an impact), and the direction away from the wall; None elsewhere.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from ..problems.abilities import Section as Section
from ..problems.abilities import Sectioned
from ..problems.protocol import Problem


@runtime_checkable
class Varied(Protocol):
    """A section that provides the derivatives of its steps (item 6 of the contract)."""

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


@runtime_checkable
class Imaged(Protocol):
    """A section that computes the steps of many points at once, with their derivatives (item 6)."""

    def images(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...

    def length(self, direction: np.ndarray) -> float: ...


@runtime_checkable
class Watched(Protocol):
    """A section whose steps are expensive, with a limit of the returns of a simulation (item 6)."""

    returns_watched: int


@runtime_checkable
class Walled(Protocol):
    """A section of motions that rebound from walls: it has `struck`, item 7 of the contract at the top of this module."""

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None: ...


def section_of(problem: Problem, p: float) -> Section:
    """Return the section of a problem at a parameter value.

    Raises
    ------
    ValueError
        If its motions cannot be simulated period by period.
    """
    if not isinstance(problem, Sectioned) or problem.spectrum != "map":
        raise ValueError(
            f"{type(problem).__name__} has no motions that can be simulated period by period, so no circles; maps, machines and flows have"
        )
    return problem.section(p)


def slopes(section: Section, x: np.ndarray, size: float) -> np.ndarray:
    """Return the derivative of ``step`` at a point, shape (d, d), by central differences.

    Parameters
    ----------
    section : Section
    x : ndarray, shape (d,)
    size : float
        Step of the differences.
    """
    result = np.empty((len(x), len(x)))
    for j in range(len(x)):
        step = np.zeros(len(x))
        step[j] = size
        result[:, j] = (section.step(x + step) - section.step(x - step)) / (2.0 * size)
    return result
