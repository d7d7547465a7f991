"""A first answer in a few lines: the stable motions of a graph, the widest first, and where none is known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..continuation.settings import Settings
from ..shared.number_text import PART, figures, figures_in
from ..text_table import Table, fitted, terminal_width
from .graph import Graph
from .measures import default_measure
from .shortening import told_apart
from .stretches import at_points, gaps, stretches, united
from .table import attractors_table, simulated, with_unit

MOST = 8  # motions that are listed


def summary(graph: Graph, width: int | None = None, brief: bool = False) -> str:
    """Stable motions of a graph: word, period, where, largest response; then what part of the interval has none.

    Of an atlas that is told in brief also the motions that most simulated starts reach.

    Parameters
    ----------
    graph : Graph
    width : int, optional
        Characters to a line; those of the terminal by default.
    brief : bool
        Whether no tables follow.
    """
    width = terminal_width() if width is None else width
    measure = default_measure(graph)
    met: dict[tuple[str, str], list[Any]] = {}
    for part in stretches(graph):
        about = part.branch.description
        name = str(about.get("word") or about.get("name", ""))
        met.setdefault((name, _kind(about)), []).append(part)
    length = graph.within[1] - graph.within[0]
    found = sorted(((_length(parts), key, parts) for key, parts in met.items()), key=lambda row: -row[0])
    listed = [row for row in found if row[0] >= PART * length][:MOST] or found[:MOST]
    short = told_apart(word for _, (word, _), _ in listed)
    rows, ends_of = [], [_united(parts) for _, _, parts in listed]
    known = [end for stable in ends_of for interval in stable for end in interval]
    number = figures_in(
        graph.within, known, same=Settings.located * length
    )  # one point, seen from two branches
    for (_, (word, kind), parts), stable in zip(listed, ends_of):
        top = max((at_points(part) for part in parts), key=lambda top: top.response)
        ends = [f"{number(a)}..{number(b)}" for a, b in stable]
        rows.append(
            (
                short[word],
                kind,
                ", ".join(ends[:3]) + (f" and {len(ends) - 3} more" if len(ends) > 3 else ""),
                f"{figures(top.response)} at {number(top.value)}" if np.isfinite(top.response) else "-",
            )
        )
    unit = graph.units.get(graph.parameter)
    head = (
        "motion",
        "type",
        f"stable in {with_unit(graph.parameter, unit)}",
        f"largest {with_unit(measure, graph.units.get(measure))}",
    )
    lines = Table(head, rows).lines(width) if rows else ["no stable motion on these branches"]
    if rows:
        count = len(graph.branches)
        lines.insert(
            0, fitted(f"stable motions of {count} branch{'' if count == 1 else 'es'}, the widest first")
        )
    if len(found) > len(listed):
        lines.append(f"and {len(found) - len(listed)} more, on narrow stretches")
    open_ = gaps(graph)
    part = sum(b - a for a, b in open_) / length
    if part >= PART and rows:
        low, high = max(open_, key=lambda gap: gap[1] - gap[0])
        where = f"{graph.parameter} = {number(low)} to {number(high)} {unit or ''}".rstrip()
        lines.append(
            fitted(
                f"no stable motion on a branch in {100.0 * part:.3g} % of the interval, most of it {where}: modulated or chaotic motions, or motions that are not connected to these"
            )
        )
    if brief and graph.attractors:
        reached = attractors_table(graph, MOST)
        lines += ["", *reached.lines(width), "", fitted(simulated(graph))]
    return "\n".join(lines)


def _kind(about: Mapping[str, Any]) -> str:
    """What kind of motion it is, in a few words."""
    periods = int(about.get("periods") or 0)
    said = ["symmetric"] if about.get("symmetric") else []
    said += [f"period {periods}"] if periods > 1 else []
    if about.get("impacts") == 0:
        said.append("no impacts")
    return ", ".join(said)


def _united(parts: list[Any]) -> list[tuple[float, float]]:
    """Intervals of the stretches, those that meet joined."""
    return united((float(part.values.min()), float(part.values.max())) for part in parts)


def _length(parts: list[Any]) -> float:
    return sum(high - low for low, high in _united(parts))
