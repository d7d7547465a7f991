"""A chart as tables: text that fits a terminal, or everything; HTML for notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from ..graph.shortening import short_word
from ..graph.table import Table, terminal_width

if TYPE_CHECKING:
    from .chart import Chart
    from .locus import Locus
    from .plane_point import PlanePoint


def table(chart: Chart, width: int | None = None) -> str:
    """Loci, points of codimension two and regions, one line each.

    Parameters
    ----------
    chart : Chart
    width : int, optional
        Characters to a line; None: as many as it takes.
    """
    lines = [_title(chart)]
    for part in _tables(chart):
        lines += ["", *part.lines(width)]
    if chart.message not in ("", "finished"):
        lines += ["", chart.message]
    return "\n".join(lines)


def shown(chart: Chart) -> str:
    """The same as it fits the terminal, if one shows it."""
    return table(chart, terminal_width())


def page(chart: Chart) -> str:
    """The same as HTML."""
    said = [] if chart.message in ("", "finished") else [f"<p>{html.escape(chart.message)}</p>"]
    return "".join([f"<p>{html.escape(_title(chart))}</p>", *(part.html() for part in _tables(chart)), *said])


def _title(chart: Chart) -> str:
    p, q = chart.parameters
    (plo, phi), (qlo, qhi) = chart.within
    return f"chart of {p} within [{plo:.6g}, {phi:.6g}] and {q} within [{qlo:.6g}, {qhi:.6g}]"


def _tables(chart: Chart) -> list[Table]:
    """Loci, then points and regions where there are any."""
    p, q = chart.parameters
    loci = [
        (
            locus.label,
            locus.kind + _realness(locus),
            short_word(str(locus.branch.description.get("word") or "")),
            f"{locus.values[:, 1].min():.6g}..{locus.values[:, 1].max():.6g}",
            f"{locus.values[:, 0].min():.6g}..{locus.values[:, 0].max():.6g}",
            str(len(locus)),
            "closed" if locus.closed else "; ".join(dict.fromkeys(locus.ended)),
        )
        for locus in chart.loci.values()
    ]
    found = [Table(("locus", "kind", "word", q, p, "points", "ended"), loci, ("points", "ended"))]
    points = [
        (
            point.label,
            point.kind,
            f"{point.value[1]:.12g}",
            f"{point.value[0]:.12g}",
            ", ".join(point.on),
            _notes(point),
        )
        for point in chart.points.values()
    ]
    regions = [
        (
            f"{region.at[1]:.4g}",
            f"{region.at[0]:.4g}",
            f"{100.0 * region.share:.1f} %",
            ", ".join(map(short_word, region.words)) or "-",
        )
        for region in chart.regions
    ]
    found += [Table(("point", "kind", q, p, "on", "coefficients"), points)] if points else []
    head = (f"region at {q}", p, "share", "stable there (simulated)")
    return [*found, *([Table(head, regions)] if regions else [])]


def _realness(locus: Locus) -> str:
    return "" if locus.real.all() else " (partly virtual)" if locus.real.any() else " (virtual)"


def _notes(point: PlanePoint) -> str:
    parts = [f"{name} = {value:.6g}" for name, value in point.coefficients.items()]
    if not point.real:
        parts.append("virtual")
    return ", ".join([*parts, point.note] if point.note else parts)
