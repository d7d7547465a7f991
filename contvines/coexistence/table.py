"""Basins as text, and as HTML for notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from ..graph.table import short_word
from ..shared.number_text import figures
from ..text_table import Table, titled

if TYPE_CHECKING:
    from .basins import Basins

ENDS = {
    "leaves": "leaves the plane",
    "long": "cut, though it goes on",
    "breaks": "cut where it cannot be followed",
}


def table(basins: Basins) -> str:
    """What the plane is, a line per attractor with its share and the interval of it, and how ragged the boundary is."""
    return titled(_title(basins), _shares(basins), _boundary(basins))


def page(basins: Basins) -> str:
    """The same as HTML."""
    shares = _shares(basins).html()
    return "".join(
        [f"<p>{html.escape(_title(basins))}</p>", shares, *(f"<p>{t}</p>" for t in _boundary(basins))]
    )


def _shares(basins: Basins) -> Table:
    rows = []
    for k, about in enumerate(basins.attractors):
        low, high = basins.interval(k)
        rows.append(
            (
                basins.told(k),
                f"k={about.periods}" if about.periods else "",
                f"{about.share:.2%}",
                f"{low:.2%} to {high:.2%}",
                f"{about.mirror_share:.2%}" if about.mirror_share else "",
            )
        )
    head = ("motion", "periods", "share", "95 % interval", "of it the mirror image")
    images = any(row[-1] for row in rows)
    return Table(head, rows) if images else Table(head[:-1], [row[:-1] for row in rows])


def _title(basins: Basins) -> str:
    across, up = basins.axes
    return f"{basins.index.size} starts in the plane {across}, {up} at {basins.parameter} = {figures(basins.value)} {basins.unit}".rstrip()


def _boundary(basins: Basins) -> list[str]:
    lines = []
    try:
        exponent, error = basins.uncertainty_exponent()
        lines.append(f"uncertainty exponent of the boundary: {exponent:.2f} +- {error:.2f}")
    except ValueError:
        pass
    for branch, word in dict.fromkeys((curve.branch, curve.word) for curve in basins.manifolds):
        pieces = [curve for curve in basins.manifolds if (curve.branch, curve.word) == (branch, word)]
        ends = [curve.ended for curve in pieces if curve.ended in ENDS]
        counted = [f"{ends.count(name)} {text}" for name, text in ENDS.items() if name in ends]
        points = sum(len(curve.points) for curve in pieces)
        several = f" in {len(pieces)} pieces between walls" if len(pieces) > len(ends) else ""
        lines.append(
            f"stable manifold of {short_word(word)} on {branch}: {points} points{several}; of {len(ends)} halves {', '.join(counted)}"
        )
    return lines
