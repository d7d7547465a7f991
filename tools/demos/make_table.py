"""Write table.json with the special points of every demo as the independent solver (`witness.py`) computes them.

    python -m tools.demos.make_table [NAME...]

Guesses come from the graphs of this package; `search.py` searches for further points.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import contvines as cv

from . import listed, maps, witness
from .demo import Demo

TABLE = Path(__file__).with_name("table.json")


def graph_of(demo: Demo) -> Any:
    """Compute the diagram of a demo with default settings."""
    make: Any = cv.AlgebraicProblem if demo.kind == "flow" else cv.MapProblem
    options = {"spectrum": "flow", **demo.options} if demo.kind == "flow" else demo.options
    problem = make(demo.function, demo.u, demo.p, parameter=demo.parameter, **options)
    return cv.diagram(problem, within=demo.within, depth=demo.depth)


def points_of(graph: Any) -> list[tuple[str, float, list[float]]]:
    """Return kind, value and unknowns of the special points, without ends of the interval."""
    points = [(s.kind, float(s.value), s.u.tolist()) for s in graph.special.values() if s.kind != "end"]
    return sorted(points, key=lambda point: (point[0], point[1]))


def solved(demo: Demo, kind: str, value: float, u: list[float]) -> tuple[float, list[float]]:
    """Return the value and unknowns (of a cycle: of its first point) from the independent solver."""
    n = len(demo.u)
    if kind in demo.exact:
        return demo.exact[kind], u[:n]
    if n > witness.SMALL:
        return witness.turning(demo, u, value)
    found, p = witness.solve(demo, kind, u[:n], value, len(u) // n)
    return float(p), [float(x) for x in found]


def main(names: list[str]) -> None:
    """Write the whole table, or the rows of some demos."""
    demos = [*listed.DEMOS, *maps.DEMOS]
    table = json.loads(TABLE.read_text(encoding="utf-8")) if names else {}
    for demo in demos:
        if names and demo.name not in names:
            continue
        rows = []
        for kind, value, u in points_of(graph_of(demo)):
            p, first = solved(demo, kind, value, u)
            rows.append(
                {
                    "kind": kind,
                    "value": p,
                    "ours": value,
                    "u": [float(f"{x:.8g}") for x in first[:6]],
                    "cycle": len(u) // len(demo.u),
                }
            )
        table[demo.name] = rows
    table = {demo.name: table[demo.name] for demo in demos}
    TABLE.write_text(json.dumps(table).replace("], ", "],\n") + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
