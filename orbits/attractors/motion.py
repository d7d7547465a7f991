"""When motions that some starts settle on are one."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Protocol

import numpy as np

from orbits.orbit import Orbit
from orbits.settings import SIMULATING

SOLVED = 1000.0  # forcing periods whose simulation takes about as long as Newton's method for a cycle
RARE = 32  # forcing periods of the longest recurrence looked for where neighbours come together


Form = tuple[Hashable, np.ndarray]
"""A motion, so that two are one if theirs are `alike`."""


class Problem(Protocol):
    """What is asked of a motion's problem: the form of a solution that all descriptions of one motion share."""

    def canonical(self, u: np.ndarray, p: float) -> Form: ...


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
