"""Text of the page docs/demos_cycles.md."""

from __future__ import annotations

import json
from typing import Any

from contvines.bifurcation.kinds import KINDS

from .listed import DEMOS, PRINTED
from .make_table import TABLE

LABELS = {kind.name: kind.label for kind in KINDS}
HEAD = """# Demos of other packages: cycles

Demos whose flows have cycles, begun at an equilibrium or at the cycle on which a motion settles (`cv.FlowProblem`, plain settings, `mirror=` where the equations have one). All special points within the
interval are listed that `cv.diagram` finds to the stated depth, Hopf points and those of cycles. *Own solve*: multiple shooting by Taylor series (heyoka, at rounding) and Newton's method on an extended system
(`tools/flow_demos/witness.py`, nothing of the package's), which has converged wherever a value stands; homoclinic orbits by bisection along the unstable manifold (scipy's DOP853), saddle-nodes on cycles by the fold of the equilibrium. A dash: not solved anew.
Printed values of AUTO-07p are those of its own run of the demo; they are on coarse meshes (its Hopf point of `chu` is 1e-4 off).
MatCont's `torBPC` is run with a3 = 0.32858, b3 = 0.93358, beta = 0.5, gamma = -0.6, r = 0.6 and epsilon = 0.001 in z' = y + epsilon, which its own points (0.00125003, -0.001, 0.000525025) solve.

LP fold, BP branch point, SB symmetry breaking, PD period doubling, NS Neimark-Sacker, all of cycles; HB Hopf; HC homoclinic orbit.

Next to two folds of `tor` (-0.799899, -0.787590) lie symmetry breakings 3e-8 and 3e-6 away; `tor, unlike` has the cycles without the symmetry. AUTO-07p's first Hopf point of `brc` is 5e-5 off.
Not listed: what lies deeper than the stated depth. `tor` goes on to -0.9 with 172 folds towards homoclinic orbits, and has period doublings down to 1e-14 beside its folds; `pen` has a doubling and a fold
1.5e-15 apart. The forced predator and prey begins at b0 = 0.5, where the motion of one forcing period attracts; its motions of two periods are a loop of their own between folds at 0.221301055 and 0.339991699.

| demo | comes with | parameter | point | found | own solve | differ by | printed |
|---|---|---|---|---|---|---|---|"""


def cycles_page() -> str:
    """Return the text of the page."""
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    lines = [HEAD]
    for demo in DEMOS:
        texts = {kind: list(values) for kind, values in PRINTED.get(demo.name, {}).items()}
        low, high = demo.within
        name, source = demo.name, demo.source
        parameter = f"{demo.parameter} in {low:.6g} to {high:.6g}"
        rows = table.get(demo.name, [])
        nearest = _nearest(texts, rows)
        for k, row in enumerate(rows):
            value = row["value"]
            own, away = ("-", "-") if value is None else (f"{_zero(value):.11g}", _difference(row))
            cells = (
                name,
                source,
                parameter,
                LABELS[row["kind"]],
                f"{_zero(row['ours']):.11g}",
                own,
                away,
                nearest.get(k, ""),
            )
            lines.append("| " + " | ".join(cells) + " |")
            name = source = parameter = ""
        if not rows:
            lines.append(f"| {name} | {source} | {parameter} | none | | | | |")
    return "\n".join(lines) + "\n"


def _zero(value: float) -> float:
    return 0.0 if abs(value) < 1e-14 else value


def _difference(row: dict[str, Any]) -> str:
    away = abs(row["ours"] - row["value"])
    return "0" if away == 0.0 else f"{away:.0e}"


def _nearest(texts: dict[str, list[str]], rows: list[dict[str, Any]]) -> dict[int, str]:
    found: dict[int, str] = {}
    for kind, values in texts.items():
        for text in values:
            of_kind = [k for k, row in enumerate(rows) if row["kind"] == kind]
            if of_kind:
                found[min(of_kind, key=lambda k: abs(rows[k]["ours"] - float(text)))] = text
    return found
