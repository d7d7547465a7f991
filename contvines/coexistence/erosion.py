"""Erosion curves: smallest kick and share of starts of a branch's stable motions against the parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..branches import Branch
from ..continuation.settings import hinted, hinting
from ..graph.table import short_word, with_unit
from ..problems.abilities import notation_of
from ..shared.figures import PlotOptions
from ..shared.numbers import figures, figures_in
from ..text_table import Table, titled
from .robustness import Robustness, refuse_uncomputed, robustness, stable_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@hinted
@dataclass
class Erosion:
    """The robustness of a branch's stable motions against the parameter.

    Attributes
    ----------
    parameter, label, word : str
        Name of the parameter; label and word of the branch.
    entries : list of Robustness
        In increasing order of the parameter.
    notation : dict
        Axis labels by name of parameter.
    """

    parameter: str
    label: str
    word: str
    entries: list[Robustness] = field(default_factory=list)
    notation: dict[str, str] = field(default_factory=dict)

    @property
    def values(self) -> np.ndarray:
        """Values of the parameter, shape (n,)."""
        return np.array([one.value for one in self.entries])

    @property
    def distances(self) -> np.ndarray:
        """Lengths of the smallest kicks that lead to another attractor (local integrity), shape (n,)."""
        return np.array([one.distance for one in self.entries])

    @property
    def shares(self) -> np.ndarray:
        """Shares of the starts that reach the motion (global integrity), shape (n,)."""
        return np.array([one.share for one in self.entries])

    @property
    def unit(self) -> str:
        """Unit of the parameter; empty for a plain number."""
        return next((one.units.get(one.parameter, "") for one in self.entries), "")

    def to_dict(self) -> dict[str, Any]:
        """Return the curve ready for JSON."""
        return {
            "parameter": self.parameter,
            "branch": self.label,
            "word": self.word,
            "values": [one.to_dict() for one in self.entries],
        }

    def __str__(self) -> str:
        values = self.values.tolist()
        value = figures_in((min(values), max(values)), values) if len(values) else figures
        rows = [
            (
                value(one.value),
                f"{one.share:.2%}",
                f"{one.distance:.4g}" if np.isfinite(one.distance) else "none",
                short_word(one.reaches),
            )
            for one in self.entries
        ]
        numbers = (with_unit(self.parameter, self.unit), "share", "smallest kick")
        table = Table((*numbers, "to"), rows, right=numbers)
        return titled(f"{self.label}  {short_word(self.word)}", table)

    def plot(self, **options: Unpack[PlotOptions]) -> Figure:
        """Plot smallest kick and share against the parameter; see :func:`contvines.plots.erosion.plot_erosion`."""
        from ..plots.erosion import plot_erosion

        return plot_erosion(self, **options)


@hinting
def erosion(
    branch: Branch,
    values: int | Sequence[float] = 16,
    *,
    units: Mapping[str, float] | None = None,
    directions: int = 64,
    starts: int | None = 512,
    seed: int = 0,
) -> Erosion:
    """Compute the robustness of a branch's stable motions at several values of the parameter.

    Parameters
    ----------
    branch : Branch
    values : int or sequence of float
        Number of values, spread evenly over the branch's stable intervals, or the values.
    units, directions, starts, seed
        As for :func:`contvines.robustness`.

    Raises
    ------
    ValueError
        If the branch has no stable real motions, or none at a given value.
    """
    places = _spread(branch, values) if isinstance(values, int) else sorted(float(v) for v in values)
    if not places:
        raise ValueError(f"values = {values!r}: give how many, 1 or more, or a list of values")
    for value in places:  # check all values before the first simulation
        stable_at(branch, value)
    word = str(branch.description.get("word", ""))
    found = Erosion(branch.parameter, branch.label, word, notation=notation_of(branch.problem))
    for value in places:
        found.entries.append(
            robustness(branch, value, units=units, directions=directions, starts=starts, seed=seed)
        )
    return found


def _spread(branch: Branch, count: int) -> list[float]:
    """Return values spread evenly over the union of the branch's stable intervals, none of them at an end."""
    intervals = sorted(branch.stable_intervals()) if branch.real else []
    merged: list[list[float]] = []
    for first, last in intervals:
        if merged and first <= merged[-1][1]:
            merged[-1][1] = max(merged[-1][1], last)
        elif last > first:
            merged.append([first, last])
    if not merged:
        refuse_uncomputed(branch)
        raise ValueError(f"{branch.label} has no stable real motions")
    ends = np.array(merged)
    lengths = np.diff(ends, axis=1)[:, 0]
    before = np.concatenate([[0.0], np.cumsum(lengths)])
    places = before[-1] * (np.arange(max(count, 0)) + 0.5) / max(count, 1)
    piece = np.clip(np.searchsorted(before, places, side="right") - 1, 0, len(ends) - 1)
    return [float(v) for v in ends[piece, 0] + places - before[piece]]
