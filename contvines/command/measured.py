"""What was measured: columns of a CSV in the units that their heads name, in the units of a study."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from orbits.machines.physical import units

if TYPE_CHECKING:
    import numpy as np

    from orbits.machines.varying import Varying


_UNIT = re.compile(r"\[([^\]]*)\]|\(([^)]*)\)|/\s*([^/]+)$")
STANDARD_GRAVITY = 9.80665  # m/s^2; in the head of an acceleration, g is this and no gram


@dataclass(frozen=True)
class Column:
    """A column that is wanted.

    Attributes
    ----------
    what : str
        In words: "time", "acceleration".
    unit : str
        In which it is returned, and counted where its head names none; "" for a plain number.
    """

    what: str
    unit: str


def measured(path: Path, wanted: Sequence[Column]) -> list[np.ndarray]:
    """The columns of a CSV, each in the unit that is wanted.

    Raises
    ------
    ValueError
        If a row cannot be read, or a head names a unit of something else.
    """
    from orbits.design.columns import read_table

    heads, rows = read_table(path, len(wanted))
    factors = [
        _factor(path, number, heads[number - 1] if number <= len(heads) else "", column)
        for number, column in enumerate(wanted, 1)
    ]
    return [rows[:, k] * factor for k, factor in enumerate(factors)]


def _factor(path: Path, number: int, head: str, column: Column) -> float:
    match = _UNIT.search(head)
    said = next((part.strip() for part in match.groups() if part), "") if match else ""
    if not said or said in ("-", "1"):
        return 1.0
    place = f"{path}: the head of column {number}, {head!r},"
    if not column.unit:
        raise ValueError(
            f"{place} names a unit, but {column.what} is a plain number here: the study has no units; leave it out, "
            'or give the study units = "si".'
        )
    if said == "g" and column.unit == "m/s^2":
        return STANDARD_GRAVITY
    factor = units.size(said, column.unit)
    if factor is None:
        raise ValueError(
            f"{place} says {said!r}, which is no unit of this {column.what}; expected {column.unit}."
        )
    return factor


Rows = list[tuple[str, float, str, str]]
"""Name, value, unit (or kind of measure) and words of each figure."""
Series = list[tuple[str, str, "np.ndarray"]]
"""Name, unit (or kind of measure) and values of each column."""


@dataclass(frozen=True)
class Scales:
    """What the dimensionless numbers of a machine are in the units that its study shows.

    Attributes
    ----------
    model : Varying
    params : float array (P,)
    """

    model: Varying
    params: np.ndarray

    def factor(self, kind: str) -> float:
        """One dimensionless unit of a kind of measure; kinds are those of `orbits.machines.varying.Varying.gauge`."""
        one = float(self.model.gauge(kind, self.params))
        if kind in ("energy", "power"):  # those of the oscillator
            one /= float(self.params[self.model.parameter_names.index("mass_ratio")])
        return one

    def unit(self, kind: str) -> str:
        """The unit of a kind of measure; "" for a plain number."""
        from orbits.machines.physical.machine import Physical

        if not isinstance(self.model, Physical):
            return self.model.units.get(kind, "") if kind == "time" else ""
        quantity = self.model.tables.gauges.get(kind)
        return units.unit_of(quantity) if quantity else ""

    def rows(self, rows: Rows) -> Rows:
        """Figures with their values and units, from dimensionless ones with the kind of measure that each is."""
        return [
            (name, float(value) * self.factor(kind), self.unit(kind), words)
            for name, value, kind, words in rows
        ]

    def columns(self, series: Series) -> Series:
        """The same of columns."""
        return [(name, self.unit(kind), values * self.factor(kind)) for name, kind, values in series]

    @property
    def metre(self) -> float:
        """Metres in one dimensionless length; 1 where there are no units."""
        unit = self.unit("length")
        return self.factor("length") * ((units.size(unit, "m") or 1.0) if unit else 1.0)
