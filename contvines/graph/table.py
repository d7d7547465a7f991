"""The graph as a readable table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .proving import mark
from .shortening import short_word, short_words

if TYPE_CHECKING:
    from .graph import Graph


def table(graph: Graph) -> str:
    """Branches, special points and switches, one line each."""
    unit = graph.units.get(graph.parameter, "")
    low, high = graph.within
    lines = [
        f"{_counted(len(graph.branches))} in {graph.parameter} within [{low:.6g}, {high:.6g}] {unit}".rstrip()
    ]
    name = with_unit(graph.parameter, unit)
    if not graph.finished:
        lines[0] += " (unfinished)"
    rows = [("branch", "what", name, "stable", "points", "ended")]
    for branch in graph.branches.values():
        about = branch.description
        what = " ".join(
            str(part)
            for part in (
                short_word(about.get("word") or about.get("name", "")),
                f"k={about['periods']}" if "periods" in about else "",
                "symmetric" if about.get("symmetric") else "",
                "" if branch.real else "virtual",
            )
            if part
        )
        lo, hi = branch.range
        stable = ", ".join(f"{a:.6g}..{b:.6g}" for a, b in branch.stable_intervals()) or "-"
        ended = "; ".join(dict.fromkeys(branch.ended))
        if branch.ended[0] == branch.ended[1] and branch.ended[0] and not branch.closed:
            ended += " (both ends)"
        rows.append((branch.label, what, f"{lo:.6g}..{hi:.6g}", stable, str(len(branch)), ended))
    lines += ["", *_columns(rows)]
    if graph.special:
        rows = [("point", "kind", "on", name, "", "leads to")]
        for point in graph.special.values():
            remarks = [point.criticality or ""]
            if not point.real:
                remarks.append("virtual")
            remarks.append(mark(graph, point.label))
            targets = []
            for switch in graph.switches:
                if switch.point == point.label:
                    arrow = f"{switch.source} -> {switch.target}"
                    targets.append(f"{arrow} ({short_words(switch.note)})" if switch.note else arrow)
            rows.append(
                (
                    point.label,
                    point.kind,
                    point.branch,
                    f"{point.value:.12g}",
                    " ".join(filter(None, remarks)),
                    "; ".join(targets),
                )
            )
        lines += ["", *_columns(rows)]
    return "\n".join(lines)


def with_unit(name: str, unit: str | None) -> str:
    """A name as the head of a column."""
    return f"{name} [{unit}]" if unit else name


def _counted(branches: int) -> str:
    return "1 branch" if branches == 1 else f"{branches} branches"


def _columns(rows: list[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
