"""Measures of motions whose flow is not at hand: of a mesh they need its discretisation alone, not the right-hand side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import mesh
from .collocation import Rule, rule
from .measures import of_mesh
from .names import OF_STATES, checked_names

BUILDER = (
    "contvines.flows.files:from_description"  # of flows whose functions can be imported; others have none
)


@dataclass(frozen=True)
class MeasuresWithoutRates:
    """Measures of equilibria or cycles of a flow that was loaded without its functions.

    Attributes
    ----------
    states : tuple of str
    rule : Rule
    intervals : int
        Of the mesh of cycles; 0 of equilibria.
    """

    states: tuple[str, ...]
    rule: Rule
    intervals: int

    @property
    def names(self) -> tuple[str, ...]:
        """As with the functions, but for those of the user."""
        each = tuple(f"{what} {state}" for what in OF_STATES for state in self.states)
        if self.intervals:
            return "norm", "period", *each
        unknowns = tuple(f"u{j}" for j in range(len(self.states)))
        return "norm", *unknowns, *self.states, *each, "period"

    def __call__(self, name: str, u: np.ndarray) -> np.ndarray:
        """A measure of solutions, shape (n, N)."""
        word, _, state = name.rpartition(" ")
        if not self.intervals:
            if name in ("norm", "period"):
                return np.linalg.norm(u, axis=1) if name == "norm" else np.full(len(u), np.nan)
            return u[:, self.states.index(state) if state in self.states else int(name[1:])].copy()
        n, m, d = self.intervals, self.rule.degree, len(self.states)
        if name == "period":  # of forced flows it is no unknown
            free = u.shape[1] > n * m * d + n
            return u[:, n * m * d].copy() if free else np.full(len(u), np.nan)
        j = self.states.index(state) if word else 0
        ends = (mesh.closed(y[: n * m * d].reshape(n, m, d)) for y in u)
        return np.array(
            [of_mesh(self.rule, each, y[-n:], word or name, j) for each, y in zip(ends, u, strict=True)]
        )


def measures_without_rates(description: Mapping[str, Any], unknowns: int) -> MeasuresWithoutRates | None:
    """What is measured of solutions with so many unknowns whose problem is described so; None if they are not those of a flow."""
    flow, cycle = description.get("flow"), description.get("cycle")
    if not isinstance(flow, Mapping) or description.get("factory") not in (None, BUILDER):
        return None
    states = checked_names(flow["states"], len(flow["x0"]))
    if cycle is None:
        found = MeasuresWithoutRates(states, rule(flow["degree"]), 0)
        return found if unknowns == len(states) else None
    found = MeasuresWithoutRates(states, rule(flow["degree"]), cycle["intervals"])
    whole = found.intervals * (found.rule.degree * len(states) + 1)
    return found if unknowns in (whole, whole + 1) else None
