"""What `contvines transient` prints, keeps and draws."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.command.measured import Rows, Series
from contvines.shared.files import write_csv
from contvines.shared.number_text import figures
from contvines.text_table import Table, titled

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure


def written(path: Path, series: Series) -> None:
    """Columns as a CSV."""
    from contvines.graph.table import with_unit

    rows = zip(*(values for _, _, values in series))
    write_csv(
        path,
        [with_unit(name, unit) for name, unit, _ in series],
        ([repr(float(x)) for x in row] for row in rows),
    )


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

    def as_json(self) -> dict[str, Any]:
        """Names and values, and their units."""
        units = {name: unit for name, _, unit, _ in self.rows if unit}
        return {**{name: value for name, value, _, _ in self.rows}, **({"units": units} if units else {})}

    def __str__(self) -> str:
        table = Table(
            ("figure", "value", "unit", "what it is"),
            [(name, figures(value), unit, words) for name, value, unit, words in self.rows],
        )
        return titled(self.title, table)

    def draw(self, size: tuple[float, float] | None = None) -> Figure:
        """The motion, or the energy, with the absorber and without; impacts as ticks."""
        from contvines.plots.measured import plot_transient

        return plot_transient(self.series[: self.drawn], self.hits, figsize=size)


def loads_rows(impulse: float, impacts: int, contact_time: float | None, shown: Mapping[str, str]) -> Rows:
    """Rows of the hardest impact, an impulse in the study's unit."""
    if not impacts:
        return []
    rows = [("impulse", impulse, shown.get("impulse", ""), "largest impulse of an impact")]
    if contact_time is not None:
        shape = f"half a sine over {contact_time:g} {shown.get('contact_time', '')}".rstrip()
        force = math.pi * impulse / (2.0 * contact_time)
        rows.append(
            ("peak_force", force, shown.get("peak_force", ""), f"of that impact, if its force is {shape}")
        )
    return rows
