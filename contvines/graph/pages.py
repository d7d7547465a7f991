"""Graphs, branches and special points as HTML, for notebooks."""

from __future__ import annotations

import html

from ..branches.branch import Branch
from ..branches.special_point import SpecialPoint
from ..shared.number_text import complex_figures
from ..shared.number_text import number_text as number
from ..text_table import Table
from .graph import Graph
from .table import (
    attractors_table,
    branches_table,
    describe,
    ends,
    simulated,
    special_table,
    stable_text,
    title,
)
from .unresolved import sentences


def graph_page(graph: Graph) -> str:
    """All tables of a graph."""
    about = f"<p>{title(graph)}</p>" + (f"<p>{html.escape(graph.start)}</p>" if graph.start else "")
    parts = [about, branches_table(graph).html()]
    if graph.special:
        parts.append(special_table(graph).html())
    parts += [f"<p>{html.escape(line)}</p>" for line in sentences(graph.unresolved, graph.parameter)]
    if graph.attractors:
        parts += [attractors_table(graph).html(), f"<p>{html.escape(simulated(graph))}</p>"]
    return "".join(parts)


def branch_page(branch: Branch) -> str:
    """What a branch is, line by line."""
    low, high = branch.range
    rows = [
        ("what", describe(branch)),
        (branch.parameter, f"{number(low, 10)}..{number(high, 10)}"),
        ("stable", stable_text(branch, lambda value: number(value, 6))),
        ("points", str(len(branch))),
        ("from .. to", ends(branch)),
        ("special points", ", ".join(label for _, label in branch.marks) or "-"),
    ]
    return Table((branch.label, "branch"), rows).html()


def point_page(point: SpecialPoint) -> str:
    """What a special point is, line by line."""
    rows = [
        (
            "kind",
            " ".join(filter(None, (point.criticality or "", point.kind, "" if point.real else "(virtual)"))),
        ),
        ("on", point.branch),
        (point.parameter, number(point.value, 14)),
        ("located to", number(point.location_error, 2)),
        ("multipliers", complex_figures(point.multipliers[:8]) or "-"),
        *([("note", point.note)] if point.note else []),
    ]
    return Table((point.label, "special point"), rows).html()
