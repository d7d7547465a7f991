"""The graph as tables: text that fits a terminal, or everything; HTML for notebooks."""

from __future__ import annotations

import html
import shutil
import sys
import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..branches.special_point import TRANSCRITICAL
from .proving import mark, told
from .shortening import short_word, short_words

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from .graph import Graph

GAP = "  "
AT_END = 1e-9  # part of the interval: special points closer to its end are at it
LEAST = 16  # characters for the last column, before its text goes on in further lines


@dataclass(frozen=True)
class Table:
    """Rows of text.

    Attributes
    ----------
    head : tuple of str
    rows : list of tuple of str
    spare : tuple of str
        Columns that may be left out where room is short, the first one first.
    """

    head: tuple[str, ...]
    rows: list[tuple[str, ...]]
    spare: tuple[str, ...] = ()

    def lines(self, width: int | None = None) -> list[str]:
        """The table in at most `width` characters: without spare columns, the last one on several lines; None: all of it."""
        columns = list(range(len(self.head)))
        columns = [c for c in columns if self.head[c] or any(row[c] for row in self.rows)]
        everything = [self.head, *self.rows]

        def widths() -> list[int]:
            return [max(len(row[c]) for row in everything) for c in columns]

        def needed() -> int:
            sizes = widths()
            return sum(sizes[:-1]) + len(GAP) * (len(sizes) - 1) + min(sizes[-1], LEAST)

        if width is not None:
            for name in self.spare:
                if needed() <= width:
                    break
                columns = [c for c in columns if self.head[c] != name]
        sizes = widths()
        left = sum(sizes[:-1]) + len(GAP) * (len(sizes) - 1)
        room = None if width is None else max(width - left, LEAST)
        lines = []
        for row in everything:
            cells = [row[c].ljust(size) for c, size in zip(columns[:-1], sizes[:-1], strict=True)]
            last = row[columns[-1]]
            parts = [last] if room is None or len(last) <= room else textwrap.wrap(last, room) or [""]
            lines.append(GAP.join([*cells, parts[0]]).rstrip())
            lines += [" " * left + part for part in parts[1:]]
        return lines

    def html(self) -> str:
        """The table as HTML."""
        head = "".join(f"<th style='text-align:left'>{html.escape(cell)}</th>" for cell in self.head)
        body = "".join(
            "<tr>"
            + "".join(f"<td style='text-align:left'>{html.escape(cell)}</td>" for cell in row)
            + "</tr>"
            for row in self.rows
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def table(graph: Graph, width: int | None = None) -> str:
    """Branches, special points and switches as text.

    Parameters
    ----------
    graph : Graph
    width : int, optional
        Characters to a line; None: as many as it takes.
    """
    about = [title(graph), graph.start] if graph.start else [title(graph)]
    lines = [*about, "", *branches_table(graph).lines(width)]
    if graph.special:
        lines += ["", *special_table(graph).lines(width)]
    return "\n".join(lines)


def shown(graph: Graph) -> str:
    """The same as it fits the terminal, if one shows it."""
    return table(graph, terminal_width())


def terminal_width() -> int | None:
    """Characters to a line where a terminal shows what is printed; None where a file, a pipe or a notebook takes it."""
    return shutil.get_terminal_size().columns if sys.stdout is not None and sys.stdout.isatty() else None


def title(graph: Graph) -> str:
    """What the tables are of, in one line."""
    count = len(graph.branches)
    low, high = graph.within
    unit = graph.units.get(graph.parameter, "")
    line = f"{count} branch{'' if count == 1 else 'es'} in {graph.parameter} within [{low:.6g}, {high:.6g}] {unit}"
    return line.rstrip() + ("" if graph.finished else " (unfinished)")


def branches_table(graph: Graph) -> Table:
    """A row per branch: what it is, where it is and is stable, and the special points at its ends, or why it ends."""
    name = with_unit(graph.parameter, graph.units.get(graph.parameter))
    rows = []
    for branch in graph.branches.values():
        low, high = branch.range
        stable = ", ".join(f"{number(a, 6)}..{number(b, 6)}" for a, b in branch.stable_intervals()) or "-"
        where = f"{number(low, 6)}..{number(high, 6)}"
        proved = told(graph, branch.label)
        rows.append((branch.label, describe(branch), where, stable, proved, str(len(branch)), ends(branch)))
    head = (
        "branch",
        "what",
        name,
        "stable",
        "proved" if any(row[4] for row in rows) else "",
        "points",
        "from .. to",
    )
    return Table(head, rows, ("points", "from .. to"))


def special_table(graph: Graph) -> Table:
    """A row per special point: its kind, branch, value, what it leads to."""
    name = with_unit(graph.parameter, graph.units.get(graph.parameter))
    rows, width = [], graph.within[1] - graph.within[0]
    for point in graph.special.values():
        side = point.criticality or (TRANSCRITICAL if TRANSCRITICAL in point.remarks else "")
        remarks = [side, "" if point.real else "virtual", mark(graph, point.label)]
        if point.kind != "end" and any(abs(point.value - end) <= AT_END * width for end in graph.within):
            remarks.append("at the end")
        targets = []
        for switch in graph.switches:
            if switch.point == point.label:
                arrow = f"{switch.source} -> {switch.target}"
                targets.append(f"{arrow} ({short_words(switch.note)})" if switch.note else arrow)
        about = " ".join(filter(None, remarks))
        rows.append(
            (point.label, point.kind, point.branch, number(point.value, 12), about, "; ".join(targets))
        )
    return Table(("point", "kind", "on", name, "", "leads to"), rows, ("",))


def describe(branch: Branch) -> str:
    """A branch in a few words: its motion's word, periods, symmetry, virtual or not."""
    about = branch.description
    parts = (
        short_word(str(about.get("word") or about.get("name", ""))),
        f"k={about['periods']}" if "periods" in about else "",
        "symmetric" if about.get("symmetric") else "",
        "" if branch.real else "virtual",
    )
    return " ".join(part for part in parts if part)


def ends(branch: Branch) -> str:
    """The labels at both ends of a branch; where there is none, why it ends there; "closed" for a circle."""
    if branch.closed:
        return "closed"
    at = dict(reversed(branch.marks))
    first, last = (at.get(i, "") for i in (0, len(branch) - 1))
    told = [label or short_words(why) or "?" for label, why in zip((first, last), branch.ended, strict=True)]
    if told[0] == told[1] and not first:
        return f"{told[0]} (both ends)"
    return " .. ".join(told)


def number(value: float, digits: int) -> str:
    """A number for people: what is only rounding is 0."""
    return "0" if abs(value) < 1e-15 else f"{value:.{digits}g}"


def with_unit(name: str, unit: str | None) -> str:
    """A name as the head of a column."""
    return f"{name} [{unit}]" if unit else name
