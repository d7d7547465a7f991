"""Basins as text, and as HTML for notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from ..text_table import Table, fitted

if TYPE_CHECKING:
    from .basins import Basins

ENDS = {
    "leaves": "leaves the plane",
    "long": "cut where it was very long",
    "breaks": "cut where the motion is not continuous",
}


def table(basins: Basins) -> str:
    """What the plane is, a line per attractor with its share and the interval of it, and how ragged the boundary is."""
    lines = [_title(basins)]
    for k, about in enumerate(basins.attractors):
        low, high = basins.interval(k)
        images = f", {about.mirror_share:.1%} of them the mirror image" if about.mirror_share else ""
        periods = f"  k={about.periods}" if about.periods else ""
        lines.append(f"  {about.name}{periods}  {about.share:.2%} ({low:.2%} to {high:.2%}{images})")
    return fitted("\n".join([*lines, *(f"  {line}" for line in _boundary(basins))]))


def page(basins: Basins) -> str:
    """The same as HTML."""
    rows = []
    for k, about in enumerate(basins.attractors):
        low, high = basins.interval(k)
        rows.append(
            (
                about.name,
                str(about.periods or ""),
                f"{about.share:.2%}",
                f"{low:.2%} to {high:.2%}",
                f"{about.mirror_share:.2%}" if about.mirror_share else "",
            )
        )
    shares = Table(("motion", "periods", "share", "95 % interval", "mirror image"), rows).html()
    return "".join(
        [f"<p>{html.escape(_title(basins))}</p>", shares, *(f"<p>{t}</p>" for t in _boundary(basins))]
    )


def _title(basins: Basins) -> str:
    across, up = basins.axes
    return (
        f"{basins.index.size} starts in the plane {across}, {up} at {basins.parameter} = {basins.value:.10g}"
    )


def _boundary(basins: Basins) -> list[str]:
    lines = []
    try:
        exponent, error = basins.uncertainty_exponent()
        lines.append(f"uncertainty exponent of the boundary: {exponent:.2f} +- {error:.2f}")
    except ValueError:
        pass
    for curve in basins.manifolds:
        lines.append(
            f"stable manifold of {curve.word} on {curve.branch}: {len(curve.points)} points, {ENDS[curve.ended]}"
        )
    return lines
