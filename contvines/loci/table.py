"""Tables of a chart: complete, fitted to the terminal, or as HTML for notebooks; and a short summary."""

from __future__ import annotations

import html
from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.motions import BAND

from ..graph.table import motion_name, short_word, with_unit
from ..shared.numbers import figures, figures_in
from ..text_table import Table, fitted, terminal_width
from .settings import PLACES

if TYPE_CHECKING:
    from .chart import Chart
    from .locus import Locus, PlanePoint
    from .regions import Region


def table(chart: Chart, width: int | None = None) -> str:
    """Return tables of loci, points of codimension two and regions, one line each.

    Parameters
    ----------
    chart : Chart
    width : int, optional
        Characters per line; None: unlimited.
    """
    lines = [fitted(title(chart), width) if width else title(chart)]
    for part in _tables(chart):
        lines += ["", *part.lines(width)]
    if chart.message not in ("", "finished"):
        lines += ["", chart.message]
    return "\n".join(lines)


def shown(chart: Chart) -> str:
    """Return the tables fitted to the width of the terminal."""
    return table(chart, terminal_width())


def page(chart: Chart) -> str:
    """Return the tables as HTML."""
    message = [] if chart.message in ("", "finished") else [f"<p>{html.escape(chart.message)}</p>"]
    return "".join(
        [f"<p>{html.escape(title(chart))}</p>", *(part.html() for part in _tables(chart)), *message]
    )


def title(chart: Chart) -> str:
    """Return the title of the tables: both parameters with their intervals."""
    p, q = chart.parameters
    (plo, phi), (qlo, qhi) = chart.within
    ends = (f"[{plo:.6g}, {phi:.6g}]", f"[{qlo:.6g}, {qhi:.6g}]")
    first, second = (
        f"{name} within {end} {chart.units.get(name, '')}".rstrip() for name, end in zip((p, q), ends)
    )
    return f"chart of {first} and {second}"


def _figures(chart: Chart) -> list[Callable[[float], str]]:
    """Functions that format values of the two parameters."""
    values = [point.value for point in chart.points.values()]
    return [
        figures_in(within, [value[k] for value in values], PLACES.same * (within[1] - within[0]))
        for k, within in enumerate(chart.within)
    ]


def _tables(chart: Chart) -> list[Table]:
    """The tables of loci, points and regions; the last two only if there are any."""
    p, q = (with_unit(name, chart.units.get(name)) for name in chart.parameters)
    at = _figures(chart)

    def range_text(locus: Locus, axis: int) -> str:
        ends = locus.values[:, axis].min(), locus.values[:, axis].max()
        return "..".join(map(at[axis], ends))

    loci = [
        (
            locus.label,
            locus.sort + _realness(locus),
            _word(locus),
            range_text(locus, 1),
            range_text(locus, 0),
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
            at[1](point.value[1]),
            at[0](point.value[0]),
            ", ".join(point.on),
            _notes(point),
        )
        for point in chart.points.values()
    ]
    found += [Table(("point", "kind", q, p, "on", "coefficients"), points)] if points else []
    return [*found, *([regions_table(chart)] if chart.regions else [])]


def regions_table(chart: Chart, most: int | None = None) -> Table:
    """Return a table with a row for each region, the largest first: place of the simulation, share of the plane, stable motions; at most `most` rows."""
    p, q = (with_unit(name, chart.units.get(name)) for name in chart.parameters)
    at = _figures(chart)
    rows = [
        (
            at[1](region.at[1]),
            at[0](region.at[0]),
            f"{100.0 * region.share:.1f} %",
            _stable(region, at),
        )
        for region in chart.regions[:most]
    ]
    if len(rows) < len(chart.regions):
        rows.append((f"and {len(chart.regions) - len(rows)} more", "", "", ""))
    return Table((f"region at {q}", p, "share", "stable (simulated)"), rows)


def _stable(region: Region, at: Sequence[Callable[[float], str]]) -> str:
    """The stable motions of a region; if its places disagree, also those at the other places."""
    text = ", ".join(map(short_word, region.words)) or "-"
    for motion in region.attractors:
        if "modulation" in motion:
            low, mean, high = (figures(motion[name]) for name in BAND)
            text += f" (per period {low} to {high}, mean {mean})"
    if not region.others:
        return text
    others = [
        f"{', '.join(map(short_word, words)) or '-'} at {at[1](place[1])}, {at[0](place[0])}"
        for place, words in region.others
    ]
    return f"{text}; elsewhere in the region: {'; '.join(others)}"


def _word(locus: Locus) -> str:
    """The word of a locus's motion; empty if solutions have no words."""
    data = locus.branch.description
    return "" if data.get("word") is None else motion_name(data.get("problem", data))


def _realness(locus: Locus) -> str:
    return "" if locus.real.all() else " (partly virtual)" if locus.real.any() else " (virtual)"


def _notes(point: PlanePoint) -> str:
    parts = [f"{name} = {figures(value)}" for name, value in point.coefficients.items()]
    if not point.real:
        parts.append("virtual")
    return ", ".join([*parts, point.note] if point.note else parts)


MOST = 8  # most regions in the summary


def chart_summary(chart: Chart, width: int | None = None) -> str:
    """Return a summary: numbers of loci and points by kind, and the largest regions.

    Parameters
    ----------
    chart : Chart
    width : int, optional
        Characters per line; by default the width of the terminal.
    """
    width = terminal_width() if width is None else width
    number = [figures_in(within) for within in chart.within]

    def spread(values: list[float], text: Callable[[float], str]) -> str:
        return "..".join(dict.fromkeys((text(min(values)), text(max(values)))))

    loci = [(locus.sort, locus.values) for locus in chart.loci.values()]
    points = [(point.kind, np.array([point.value])) for point in chart.points.values()]
    rows = []
    for each in (loci, points):
        for kind, count in Counter(kind for kind, _ in each).most_common():
            values = np.concatenate([values for kind_of, values in each if kind_of == kind])
            ranges = (spread([values[:, k].min(), values[:, k].max()], number[k]) for k in (1, 0))
            rows.append((kind, str(count), *ranges))
    p, q = (with_unit(name, chart.units.get(name)) for name in chart.parameters)
    lines = [title(chart), "", *Table(("loci and points", "number", q, p), rows).lines(width)]
    if chart.regions:
        lines += ["", *regions_table(chart, MOST).lines(width)]
    return "\n".join(lines)
