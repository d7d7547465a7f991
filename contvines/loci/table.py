"""A chart as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .plane_point import PlanePoint

if TYPE_CHECKING:
    from .chart import Chart


def table(chart: Chart) -> str:
    """Loci, points of codimension two and regions, one line each."""
    p, q = chart.parameters
    (plo, phi), (qlo, qhi) = chart.within
    lines = [f"chart of {p} within [{plo:.6g}, {phi:.6g}] and {q} within [{qlo:.6g}, {qhi:.6g}]", ""]
    head = ("locus", "kind", "word", q, p, "points", "ended")
    rows = []
    for locus in chart.loci.values():
        values = locus.values
        about = locus.branch.description
        ends = "closed" if locus.closed else "; ".join(dict.fromkeys(locus.ended))
        rows.append(
            (
                locus.label,
                locus.kind
                + ("" if locus.real.all() else " (partly virtual)" if locus.real.any() else " (virtual)"),
                str(about.get("word") or ""),
                f"{values[:, 1].min():.6g}..{values[:, 1].max():.6g}",
                f"{values[:, 0].min():.6g}..{values[:, 0].max():.6g}",
                str(len(locus)),
                ends,
            )
        )
    lines += _aligned(head, rows)
    if chart.points:
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
        lines += ["", *_aligned(("point", "kind", q, p, "on", "coefficients"), points)]
    if chart.regions:
        regions = [
            (
                f"{region.at[1]:.4g}",
                f"{region.at[0]:.4g}",
                f"{100.0 * region.share:.1f} %",
                ", ".join(region.words) or "-",
            )
            for region in chart.regions
        ]
        lines += ["", *_aligned((f"region at {q}", p, "share", "stable there (simulated)"), regions)]
    if chart.message not in ("", "finished"):
        lines += ["", chart.message]
    return "\n".join(lines)


def _notes(point: PlanePoint) -> str:
    parts = [f"{name} = {value:.6g}" for name, value in point.coefficients.items()]
    if not point.real:
        parts.append("virtual")
    return ", ".join([*parts, point.note] if point.note else parts)


def _aligned(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in [head, *rows]
    ]
