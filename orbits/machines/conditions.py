"""Parameters that depend on a condition, a temperature for example: tables between whose rows they run linearly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from orbits.machines.parameters import ParameterError


@dataclass(frozen=True)
class Table:
    """A parameter over a condition.

    Attributes
    ----------
    parameter, condition : str
        Names.
    places, values : tuple of float
        Of the condition, ascending, and of the parameter.
    """

    parameter: str
    condition: str
    places: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        steps = np.diff(self.places)
        if len(self.places) < 2 or len(self.places) != len(self.values) or not np.all(steps > 0.0):
            raise ParameterError(
                f"{self.parameter} over {self.condition}: give two rows or more [{self.condition}, {self.parameter}], {self.condition} ascending"
            )

    def __call__(self, condition: float) -> float:
        """The parameter's value, linear between two rows.

        Raises
        ------
        ParameterError
            Outside of the table.
        """
        low, high = self.places[0], self.places[-1]
        if not low <= condition <= high:
            raise ParameterError(
                f"{self.condition} = {condition:g} lies outside the table of {self.parameter}, which goes from {low:g} to {high:g}: "
                f"give a row for it, or a {self.condition} within"
            )
        return float(np.interp(condition, self.places, self.values))


def resolved(tables: Iterable[Table], values: Mapping[str, float]) -> dict[str, float]:
    """Values with conditions replaced by the parameters that depend on them.

    Raises
    ------
    ParameterError
        If a condition lies outside of a table.
    """
    found = dict(values)
    for table in tables:
        if table.condition in values:
            found[table.parameter] = table(values[table.condition])
            found.pop(table.condition, None)
    return found
