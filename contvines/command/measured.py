"""Numbers beside a measurement: columns of a CSV in the units that their heads name, and what is computed in the units of a study, as a table, a CSV and a picture."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbits.machines.physical import units

from ..graph.table import with_unit
from ..shared.files import write_csv
from ..shared.numbers import figures
from ..text_table import Table, titled
from .frame import say

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure

    from orbits.machines.varying import Varying


_UNIT = re.compile(r"\[([^\]]*)\]|\(([^)]*)\)|/\s*([^/]+)$")
STANDARD_GRAVITY = 9.80665  # m/s^2; in the head of an acceleration, g is this and no gram


def measured(path: Path, wanted: Mapping[str, str]) -> list[np.ndarray]:
    """The columns of a CSV, each in the unit that is wanted.

    Parameters
    ----------
    path : Path
    wanted : mapping
        What each column is, in words ("time"), and the unit in which it is returned, and counted where its head names none; "" for a plain number.

    Raises
    ------
    ValueError
        If a row cannot be read, or a head names a unit of something else.
    """
    from orbits.design.columns import read_table

    heads, rows = read_table(path, len(wanted))
    return [
        rows[:, k]
        * _factor(f"{path}: the head of column {k + 1}", heads[k] if k < len(heads) else "", *column)
        for k, column in enumerate(wanted.items())
    ]


def _factor(place: str, head: str, what: str, unit: str) -> float:
    match = _UNIT.search(head)
    said = next((part.strip() for part in match.groups() if part), "") if match else ""
    if not said or said in ("-", "1"):
        return 1.0
    place = f"{place}, {head!r},"
    if not unit:
        raise ValueError(
            f"{place} names a unit, but {what} is a plain number here: the study has no units; leave it out, "
            'or give the study units = "si".'
        )
    if said == "g" and unit == "m/s^2":
        return STANDARD_GRAVITY
    factor = units.size(said, unit)
    if factor is None:
        raise ValueError(f"{place} says {said!r}, which is no unit of this {what}; expected {unit}.")
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

    def number(self, option: str, text: str, kind: str) -> float:
        """The dimensionless number of what an option says, a quantity with a unit where there are units."""
        return units.counted(option, text, self.unit(kind)) / self.factor(kind)

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


def written(path: Path | None, series: Series, quiet: bool) -> None:
    """Columns as a CSV, where one is wanted."""
    if path is None:
        return
    heads = [with_unit(name, unit) for name, unit, _ in series]
    rows = zip(*(values for _, _, values in series))
    write_csv(path, heads, ([repr(float(x)) for x in row] for row in rows))
    say(f"kept in {path}", quiet)


@dataclass
class Told:
    """A transient in the study's units.

    Attributes
    ----------
    title : str
    rows : list of (name, value, unit, words)
    series : list of (name, unit, float array)
        The first is time.
    hits : float array
        Times of impacts.
    drawn : int, optional
        How many of the series the picture has.
    """

    title: str
    rows: Rows
    series: Series
    hits: np.ndarray | None = None
    drawn: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """Names and values, and their units."""
        units = {name: unit for name, _, unit, _ in self.rows if unit}
        return {**{name: value for name, value, _, _ in self.rows}, **({"units": units} if units else {})}

    def __str__(self) -> str:
        rows = [(name, figures(value), unit, words) for name, value, unit, words in self.rows]
        return titled(self.title, Table(("figure", "value", "unit", "what it is"), rows))

    def plot(self, figsize: tuple[float, float] | None = None) -> Figure:
        """The motion, or the energy, with the absorber and without; impacts as ticks."""
        from ..plots.measured import plot_transient

        return plot_transient(self.series[: self.drawn], self.hits, figsize=figsize)


def loads_rows(impulse: float, impacts: int, contact_time: float | None, shown: Mapping[str, str]) -> Rows:
    """Rows of the hardest impact, an impulse in the study's unit."""
    if not impacts:
        return []
    rows = [("impulse", impulse, shown.get("impulse", ""), "largest impulse of an impact")]
    if contact_time is not None:
        shape = f"half a sine over {contact_time:g} {shown.get('contact_time', '')}".rstrip()
        words = f"of that impact, if its force is {shape}"
        rows.append(
            ("peak_force", math.pi * impulse / (2.0 * contact_time), shown.get("peak_force", ""), words)
        )
    return rows
