"""Tables as text, at the width of the terminal or in full, and as HTML for notebooks."""

from __future__ import annotations

import html
import shutil
import sys
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

GAP = "  "
LEAST = 16  # smallest width of the last column in characters; longer text is wrapped


@dataclass(frozen=True)
class Table:
    """A table of text cells.

    Attributes
    ----------
    head : tuple of str
        Names of the columns.
    rows : list of tuple of str
    spare : tuple of str
        Names of columns that a narrow terminal may leave out, the most dispensable first.
    right : tuple of str
        Names of right-aligned columns.
    """

    head: tuple[str, ...]
    rows: list[tuple[str, ...]]
    spare: tuple[str, ...] = ()
    right: tuple[str, ...] = ()

    def lines(self, width: int | None = None) -> list[str]:
        """Return the lines of the table, of at most `width` characters; None for no limit.

        If the table is too wide, spare columns are left out and the last column is wrapped; if it is still too wide, each
        cell gets a line of its own.
        """
        columns = list(range(len(self.head)))
        columns = [c for c in columns if self.head[c] or any(row[c] for row in self.rows)]
        everything = [self.head, *self.rows]

        def widths() -> list[int]:
            return [max(len(row[c]) for row in everything) for c in columns]

        def needed() -> int:
            sizes = widths()
            least = max(len(part) for row in everything for part in (row[columns[-1]].split() or [""]))
            return sum(sizes[:-1]) + len(GAP) * (len(sizes) - 1) + min(sizes[-1], max(LEAST, least))

        if width is not None:
            for name in self.spare:
                if needed() <= width:
                    break
                columns = [c for c in columns if self.head[c] != name]
            if needed() > width:
                return self._stacked(width)
        sizes = widths()
        left = sum(sizes[:-1]) + len(GAP) * (len(sizes) - 1)
        room = None if width is None else max(width - left, LEAST)
        lines = []
        for row in everything:
            cells = [
                row[c].rjust(size) if self.head[c] in self.right else row[c].ljust(size)
                for c, size in zip(columns[:-1], sizes[:-1], strict=True)
            ]
            last = row[columns[-1]]
            if self.head[columns[-1]] in self.right:
                last = last.rjust(sizes[-1])
            parts = [last] if room is None or len(last) <= room else _wrapped(last, room)
            lines.append(GAP.join([*cells, parts[0]]).rstrip())
            lines += [" " * left + part for part in parts[1:]]
        return lines

    def _stacked(self, width: int) -> list[str]:
        """Return the lines of a table with a line for each cell; the first cell of a row begins a block."""
        names = max(len(name) for name in self.head[1:])
        lines = []
        for row in self.rows:
            lines += _wrapped(f"{self.head[0]} {row[0]}" if self.head[0] else row[0], width)
            for name, cell in zip(self.head[1:], row[1:], strict=True):
                if cell:
                    start = f"{GAP}{name.ljust(names)}{GAP}"
                    first, *rest = _wrapped(cell, max(width - len(start), LEAST))
                    lines += [start + first, *(" " * len(start) + part for part in rest)]
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


def terminal_width() -> int | None:
    """Return the width of the terminal in characters; None if stdout is a file, a pipe or a notebook."""
    return shutil.get_terminal_size().columns if sys.stdout is not None and sys.stdout.isatty() else None


def titled(title: str, table: Table, further: Sequence[str] = ()) -> str:
    """Return a title, a table, and further lines below it as one text, fitted to the terminal."""
    below = ["", *map(fitted, further)] if further else []
    return "\n".join([fitted(title), "", *table.lines(terminal_width()), *below])


def fitted(text: str, width: int | None = None) -> str:
    """Wrap the long lines of a text to `width` characters, continuation lines indented; None for the width of the terminal, if there is one."""
    width = width or terminal_width()
    if width is None:
        return text
    lines: list[str] = []
    for line in text.split("\n"):
        start = line[: len(line) - len(line.lstrip())]
        lines += [line] if len(line) <= width else _wrapped(line.strip(), width, start, start + GAP)
    return "\n".join(lines)


def _wrapped(text: str, width: int, first: str = "", later: str = "") -> list[str]:
    """Wrap text at spaces only; a word longer than a line stays whole."""
    wrapped = textwrap.wrap(
        text,
        width,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return wrapped or [""]
