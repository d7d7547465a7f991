"""What some starts settle on, as atlases and basins get it."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from orbits.orbit import Orbit
from orbits.settings import SIMULATING

SIGMAS = 3.0  # an exponent that many standard errors above zero is chaos
SOLVED = 1000.0  # forcing periods whose simulation takes about as long as Newton's method for a cycle
RARE = 32  # forcing periods of the longest recurrence looked for where neighbours come together


Form = tuple[Hashable, np.ndarray]
"""A motion, so that two are one if theirs are `alike`."""


class Problem(Protocol):
    """What is asked of a motion's problem: the form of a solution that all descriptions of one motion share."""

    def canonical(self, u: np.ndarray, p: float) -> Form: ...


@dataclass(frozen=True, eq=False)
class Motion:
    """One attractor as `contvines` gets it.

    Attributes
    ----------
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, or
        ``impossible`` (the start lies inside a wall).
    word : str
    periods : int
    problem, u : Problem and float array, or None
        The motion as a solution, where it has a word.
    exponent, error : float
        Largest Lyapunov exponent per forcing period and its standard error; nan for motions that recur.
    state : float array (S,)
        From which a simulation goes on.
    """

    kind: str
    word: str = ""
    periods: int = 0
    problem: Problem | None = field(default=None, repr=False)
    u: np.ndarray | None = field(default=None, repr=False)
    exponent: float = float("nan")
    error: float = float("nan")
    state: np.ndarray | None = field(default=None, repr=False)


def wandering(exponent: float, error: float, roomy: bool) -> str:
    """The kind of a motion that does not recur, from its largest Lyapunov exponent and the standard error of it.

    Parameters
    ----------
    exponent, error : float
    roomy : bool
        Whether the states have room for two incommensurate frequencies.
    """
    if exponent > SIGMAS * error:
        return "chaotic"
    return "quasi-periodic" if roomy and exponent > -SIGMAS * error else "slow"


def distinct(cycles: Iterable[Orbit], parameter: str, p: float) -> list[tuple[Problem, np.ndarray]]:
    """Problems and unknowns of orbits at a value of a parameter, each motion once."""
    found: list[tuple[Problem, np.ndarray]] = []
    forms: list[Form] = []
    for orbit in cycles:
        problem = orbit.problem(parameter)
        u = orbit.seed(problem)[0]
        form = problem.canonical(u, p)
        if not any(alike(form, known) for known in forms):
            forms.append(form)
            found.append((problem, u))
    return found


def alike(one: Form, other: Form) -> bool:
    """Whether two canonical forms are those of one motion."""
    return one[0] == other[0] and np.allclose(one[1], other[1], atol=SIMULATING.same)
