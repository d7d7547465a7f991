"""Measures of the user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .functions import NotEvaluable, UserFunction
from .parameters import ParameterSet


class Outputs:
    """Functions (u, p) -> number by name.

    Parameters
    ----------
    given : mapping of str to callable, or None
    parameters : ParameterSet

    Raises
    ------
    ValueError
        If one is not callable or its name is no text.
    """

    def __init__(self, given: Mapping[str, Callable] | None, parameters: ParameterSet) -> None:
        self.given = dict(given or {})
        for name, f in self.given.items():
            if not (isinstance(name, str) and callable(f)):
                raise ValueError(f"outputs: {name!r} must be a name with a function (u, p) -> number")
        self.functions = {
            name: UserFunction(f, f"the output {name}", parameters) for name, f in self.given.items()
        }

    @property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self.given)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Their values for solutions u of shape (m, N) at parameter values p of shape (m,); NaN where they fail."""
        return {
            name: np.array([self._one(name, *pair) for pair in zip(u, np.atleast_1d(p))]) for name in names
        }

    def _one(self, name: str, u: np.ndarray, p: float) -> float:
        try:
            return float(self.functions[name](u, float(p))[0])
        except (NotEvaluable, IndexError):
            return float("nan")
