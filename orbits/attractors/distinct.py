"""Of many cycles each motion once, as problems with their unknowns."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

SAME = 1e-5  # difference of two canonical forms that are one


def distinct(cycles: Iterable[Any], parameter: str, p: float) -> list[tuple[Any, np.ndarray]]:
    """Problems and unknowns of orbits at a value of a parameter, each motion once."""
    found: list[tuple[Any, np.ndarray]] = []
    forms: list[tuple[Any, np.ndarray]] = []
    for orbit in cycles:
        problem = orbit.problem(parameter)
        u = orbit.seed(problem)[0]
        form = problem.canonical(u, p)
        if not any(alike(form, known) for known in forms):
            forms.append(form)
            found.append((problem, u))
    return found


def alike(one: tuple[Any, np.ndarray], other: tuple[Any, np.ndarray]) -> bool:
    """Whether two canonical forms are those of one motion."""
    return one[0] == other[0] and np.allclose(one[1], other[1], atol=SAME)
