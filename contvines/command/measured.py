"""Measured data (CSV columns with units in their heads), and computed results in the units of a study, as table, CSV and picture."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orbits.machines.physical import units

from ..continuation.settings import Settings
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
STANDARD_GRAVITY = 9.80665  # m/s^2: the unit g in the head of an acceleration, which is not the gram there


def measured(path: Path, wanted: Mapping[str, str]) -> list[np.ndarray]:
    """Read the columns of a CSV file, converted to the units of a study.

    Parameters
    ----------
    path : Path
    wanted : mapping
        Unit of each returned column by its meaning in words ("time"), also the unit of columns whose heads name none; "" for a plain number.

    Raises
    ------
    ValueError
        If a row cannot be read, or a head names a unit of another dimension.
    """
    from orbits.design.columns import read_table

    heads, rows = read_table(path, len(wanted))
    return [
        rows[:, k]
        * _factor(f"{path}: the head of column {k + 1}", heads[k] if k < len(heads) else "", *column)
        for k, column in enumerate(wanted.items())
    ]


def _factor(place: str, head: str, quantity: str, unit: str) -> float:
    match = _UNIT.search(head)
    text = next((part.strip() for part in match.groups() if part), "") if match else ""
    if not text or text in ("-", "1"):
        return 1.0
    place = f"{place}, {head!r},"
    if not unit:
        raise ValueError(
            f"{place} names a unit, but {quantity} is a plain number here: the study has no units; leave it out, "
            'or give the study units = "si".'
        )
    if text == "g" and unit == "m/s^2":
        return STANDARD_GRAVITY
    factor = units.size(text, unit)
    if factor is None:
        raise ValueError(f"{place} says {text!r}, which is no unit of this {quantity}; expected {unit}.")
    return factor


Rows = list[tuple[str, float, str, str]]
"""Name, value, unit (or kind of measure) and description of each number."""
Series = list[tuple[str, str, "np.ndarray"]]
"""Name, unit (or kind of measure) and values of each column."""


@dataclass(frozen=True)
class Scales:
    """Conversion of a machine's dimensionless numbers to the units of its study.

    Attributes
    ----------
    model : Varying
    params : float array (P,)
        Values of the machine's parameters.
    """

    model: Varying
    params: np.ndarray

    def factor(self, kind: str) -> float:
        """Return the size of one dimensionless unit of a kind of measure; kinds are those of `orbits.machines.varying.Varying.gauge`."""
        one = float(self.model.gauge(kind, self.params))
        if kind in ("energy", "power"):  # relative to the oscillator's mass, not the absorber's
            one /= float(self.params[self.model.parameter_names.index("mass_ratio")])
        return one

    def unit(self, kind: str) -> str:
        """Return the unit of a kind of measure; "" for a plain number."""
        from orbits.machines.physical.machine import Physical

        if not isinstance(self.model, Physical):
            return self.model.units.get(kind, "") if kind == "time" else ""
        quantity = self.model.tables.gauges.get(kind)
        return units.unit_of(quantity) if quantity else ""

    def number(self, option: str, text: str, kind: str) -> float:
        """Convert the text of an option, with a unit if the study has units, to a dimensionless number."""
        return units.counted(option, text, self.unit(kind)) / self.factor(kind)

    def rows(self, rows: Rows) -> Rows:
        """Convert rows of dimensionless numbers, with kinds of measures in place of units, to the units of the study."""
        return [
            (name, float(value) * self.factor(kind), self.unit(kind), words)
            for name, value, kind, words in rows
        ]

    def columns(self, series: Series) -> Series:
        """Convert columns likewise."""
        return [(name, self.unit(kind), values * self.factor(kind)) for name, kind, values in series]

    @property
    def metre(self) -> float:
        """Size of the dimensionless unit of length in metres; 1 for a study without units."""
        unit = self.unit("length")
        return self.factor("length") * ((units.size(unit, "m") or 1.0) if unit else 1.0)


def written(path: Path | None, series: Series, quiet: bool) -> None:
    """Write columns as a CSV file, if a path is given."""
    if path is None:
        return
    heads = [with_unit(name, unit) for name, unit, _ in series]
    rows = zip(*(values for _, _, values in series))
    write_csv(path, heads, ([repr(float(x)) for x in row] for row in rows))
    say(f"kept in {path}", quiet)


@dataclass
class Measured:
    """Computed numbers and columns in the study's units: a transient, or a random response with standard errors.

    Attributes
    ----------
    title : str
    rows : list of (name, value, unit, words)
    series : list of (name, unit, float array)
        The first is time, or frequency of a random response.
    hits : float array
        Times of impacts.
    drawn : int, optional
        Number of series in the picture.
    errors : dict, optional
        Standard error of each value, by name.
    """

    title: str
    rows: Rows
    series: Series
    hits: np.ndarray | None = None
    drawn: int | None = None
    errors: dict[str, float] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers (with standard errors if there are some) by name, and their units, ready for JSON."""
        units = {name: unit for name, _, unit, _ in self.rows if unit}
        if (errors := self.errors) is not None:
            return {name: {"value": x, "error": errors[name]} for name, x, _, _ in self.rows} | {
                "units": units
            }
        return {**{name: value for name, value, _, _ in self.rows}, **({"units": units} if units else {})}

    def __str__(self) -> str:
        errors = self.errors or {}
        rows = [
            (name, *_rounded(value, errors.get(name, math.nan)), unit, words)
            for name, value, unit, words in self.rows
        ]
        return titled(
            self.title, Table(("figure", "value", "+-" if errors else "", "unit", "what it is"), rows)
        )

    def plot(self, figsize: tuple[float, float] | None = None) -> Figure:
        """Plot the motion, or the energy, with and without the absorber; impacts are marked as ticks. Of a random response plot the spectral densities."""
        from ..plots.measured import plot_densities, plot_transient

        if self.errors is None:
            return plot_transient(self.series[: self.drawn], self.hits, figsize=figsize)
        (_, hertz, frequencies), *densities = self.series
        curves = {name: (values, unit) for name, unit, values in densities}
        return plot_densities(frequencies, hertz, curves, figsize=figsize)


def _rounded(value: float, error: float) -> tuple[str, str]:
    """Format a number to the second digit of its error, and the error."""
    if not (error > 0.0 and math.isfinite(error)) or error < Settings.located * abs(value):
        return figures(value), "" if math.isnan(error) else "0"
    digits = max(2, min(6, math.ceil(math.log10(max(abs(value), error) / error)) + 2))
    return f"{value:.{digits}g}", f"{error:.2g}"


def loads_rows(impulse: float, impacts: int, contact_time: float | None, units: Mapping[str, str]) -> Rows:
    """Return the rows about the hardest impact, whose impulse is in the study's unit."""
    if not impacts:
        return []
    rows = [("impulse", impulse, units.get("impulse", ""), "largest impulse of an impact")]
    if contact_time is not None:
        shape = f"half a sine over {contact_time:g} {units.get('contact_time', '')}".rstrip()
        words = f"of that impact, if its force is {shape}"
        rows.append(
            ("peak_force", math.pi * impulse / (2.0 * contact_time), units.get("peak_force", ""), words)
        )
    return rows
