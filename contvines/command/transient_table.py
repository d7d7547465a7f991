"""What `contvines transient` prints, keeps and draws."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.shared.number_text import figures

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure


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

    def __init__(
        self,
        title: str,
        rows: list[tuple[str, float, str, str]],
        series: list[tuple[str, str, np.ndarray]],
        hits: np.ndarray | None = None,
        drawn: int | None = None,
    ) -> None:
        self.title, self.rows, self.series, self.hits, self.drawn = title, rows, series, hits, drawn

    def as_json(self) -> dict[str, Any]:
        """Names and values, and their units."""
        units = {name: unit for name, _, unit, _ in self.rows if unit}
        return {**{name: value for name, value, _, _ in self.rows}, **({"units": units} if units else {})}

    def __str__(self) -> str:
        from contvines.text_table import Table, fitted, terminal_width

        table = Table(
            ("figure", "value", "unit", "what it is"),
            [(name, figures(value), unit, words) for name, value, unit, words in self.rows],
        )
        return "\n".join([fitted(self.title), "", *table.lines(terminal_width())])

    def write(self, path: Path) -> None:
        """The series as a CSV."""
        import csv

        from contvines.graph.table import with_unit

        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([with_unit(name, unit) for name, unit, _ in self.series])
            writer.writerows(
                [repr(float(x)) for x in row] for row in zip(*(values for _, _, values in self.series))
            )

    def draw(self, size: tuple[float, float] | None = None) -> Figure:
        """The motion, or the energy, with the absorber and without; impacts as ticks."""
        from contvines.plots.measured import plot_transient

        return plot_transient(self.series[: self.drawn], self.hits, figsize=size)


def loads_rows(
    impulse: float, impacts: int, contact_time: float | None, shown: Mapping[str, str]
) -> list[tuple[str, float, str, str]]:
    """Rows of the hardest impact."""
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
