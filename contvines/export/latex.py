"""Export of a graph as LaTeX tables of its branches and special points, with the rules of the package booktabs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from ..graph.table import branches_table, special_table, title
from ..journal import comments
from ..text_table import Table

if TYPE_CHECKING:
    from ..graph import Graph

_SPECIAL = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "->": r"$\to$", "<": r"$<$", ">": r"$>$",
    "μ": r"$\mu$", "Ω": r"$\Omega$", "ε": r"$\varepsilon$", "λ": r"$\lambda$", "π": r"$\pi$", "²": r"$^2$", "…": r"\dots{}",
}  # fmt: skip
_FOUND = re.compile("|".join(re.escape(text) for text in sorted(_SPECIAL, key=len, reverse=True)))
_NUMBER = re.compile(r"^[-+]?\d+(\.\d+)?(e[-+]?\d+)?$")
_POWER = re.compile(r"e([-+]?)0*(\d+)$")


def write_latex(graph: Graph, path: Path) -> None:
    """Write the tables to a file for ``\\input``; the preamble needs ``\\usepackage{booktabs}``."""
    tables = [branches_table(graph)] + ([special_table(graph, reasons=False)] if graph.special else [])
    lines = [f"% {line}".rstrip() for line in (title(graph), *comments(graph), r"\usepackage{booktabs}")]
    for table in tables:
        lines += ["", *tabular(table)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def tabular(table: Table) -> list[str]:
    """Return the lines of a ``tabular``: empty columns are left out, columns of numbers are right-aligned."""
    columns = [c for c, name in enumerate(table.head) if name or any(row[c] for row in table.rows)]
    sides = ["r" if all(_NUMBER.match(row[c]) for row in table.rows) and table.rows else "l" for c in columns]
    return [
        rf"\begin{{tabular}}{{{''.join(sides)}}}",
        r"\toprule",
        " & ".join(escaped(table.head[c]) for c in columns) + r" \\",
        r"\midrule",
        *(" & ".join(cell(row[c]) for c in columns) + r" \\" for row in table.rows),
        r"\bottomrule",
        r"\end{tabular}",
    ]


def cell(text: str) -> str:
    """Return a cell as LaTeX; numbers are set in mathematics mode."""
    if not _NUMBER.match(text):
        return escaped(text)
    return "$" + _POWER.sub(_as_power, text) + "$"


def _as_power(found: re.Match[str]) -> str:
    return rf" \times 10^{{{found[1].lstrip('+')}{found[2]}}}"


def escaped(text: str) -> str:
    """Escape the special characters of LaTeX in a text."""
    return _FOUND.sub(lambda found: _SPECIAL[found[0]], text).replace("..", "\\,--\\,")
