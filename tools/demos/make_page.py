"""Write docs/demos.md and docs/demos_cycles.md from the tables.

python -m tools.demos.make_page
"""

from __future__ import annotations

import json
from pathlib import Path

from contvines.bifurcation.kinds import BY_NAME

from ..flow_demos.page import cycles_page
from . import listed, maps
from .make_table import TABLE
from .units import SETS, UNITS

DOCS = Path(__file__).parents[2] / "docs"
PAGES = DOCS / "demos.md", DOCS / "demos_cycles.md"
HEAD = """# Demos of other packages

{demos} problems of equilibria and maps that come with AUTO-07p, MatCont, MatContM, BifurcationKit, PyDSTool, COCO and XPPAUT, or stand in
textbooks, with the equations and starts of their sources, unscaled, and with plain settings: `cv.diagram(problem, within=...)`. All
{points} special points are found, and no others. [Cycles of flows](demos_cycles.md) have a page of their own.

The values are not this package's: each is a solution, in thirty digits, of its defining equations (F = 0 with a singular Jacobian, a
vanishing Hurwitz determinant, a multiplier -1, a product of multipliers 1). The package agrees with each to 1e-10 or better, most to
1e-15 (the largest difference as a part of the interval, when the page was made, stands in the table); a test says so. That there are
no more was asked by Newton's method for the same equations from 150 random starts for each kind (cycles of length one, up to six unknowns). Cycles are followed to twice or four times their length only.

Printed is what the source prints; a closed form is what its equations say by hand. *None printed*: the sources print no value. The first five digits
of every value were looked for, without result, in the repositories of AUTO-07p (manual, demos and log of its test), PyDSTool, BifurcationKit and its documentation (as written
and as rendered), MatContM and cl_matcontL. These demos show their values when they are run, or as pictures, or are those of a textbook.
The manuals and tutorials of MatCont, MatContM and COCO are no repositories, and were not available whole.

In other units: the same demos with u, p and the rows of F times 1e9 or 1e-9, in {sets} sets of units that nothing is said about
(`python -m tools.demos.units`); the column counts those in which the special points are the same to 1e-10: {alike} of {all} in all.

LP fold, BP branch point, SB symmetry breaking, HB Hopf, PD period doubling, NS Neimark-Sacker; ^2 a cycle of length two.
"""


def render() -> str:
    """Return the text of docs/demos.md."""
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    demos = [*listed.DEMOS, *maps.DEMOS]
    alike = json.loads(UNITS.read_text(encoding="utf-8"))
    lines = [
        HEAD.format(
            demos=len(demos),
            points=sum(len(rows) for rows in table.values()),
            sets=len(SETS),
            alike=sum(alike.values()),
            all=len(SETS) * len(demos),
        )
    ]
    for title, kind in (("Equilibria", "flow"), ("Maps", "map")):
        lines += [
            f"## {title}",
            "",
            "| demo | comes with | parameter | special points | ours differ by | in other units | printed |",
            "|---|---|---|---|---|---|---|",
        ]
        for demo in demos:
            if demo.kind != kind:
                continue
            found: dict[str, list[str]] = {}
            away: list[float] = []
            for row in table[demo.name]:
                label = BY_NAME[row["kind"]].label + (f"^{row['cycle']}" if row["cycle"] > 1 else "")
                value = 0.0 if abs(row["value"]) < 1e-14 else row["value"]
                found.setdefault(label, []).append(f"{value:.11g}")
                away.append(abs(row["ours"] - row["value"]) / (demo.within[1] - demo.within[0]))
            points = "; ".join(f"{label} {', '.join(values)}" for label, values in found.items()) or "none"
            low, high = demo.within
            cells = (
                demo.name,
                demo.source,
                f"{demo.parameter} in {low:g} to {high:g}",
                points,
                ("0" if max(away) == 0.0 else f"{max(away):.0e}") if away else "",
                str(alike[demo.name]),
                demo.printed or "none printed",
            )
            lines.append("| " + " | ".join(cells) + " |")
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    for path, text in zip(PAGES, (render(), cycles_page())):
        path.write_text(text, encoding="utf-8")
