"""Write units.json with results of the demos in other units: u, p and the rows of F are multiplied by 1e-9 to 1e9.

    python -m tools.demos.units [NAME...]

Differences from table.json are printed: additional or missing special points, and values that differ by more than 1e-10 of themselves (near zero:
1e-12 of the interval). The problem has no information on its units. The rows of a map have the units of its unknowns.
"""

from __future__ import annotations

import json
import sys
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

import contvines as cv

from . import listed, maps
from .demo import NUMBERS, Demo
from .make_table import TABLE, points_of

UNITS = Path(__file__).with_name("units.json")
# factors of unknowns, parameter, rows
SETS = [(1e9, 1e-9, 1e9), (1e-9, 1e9, 1e-9), (1e9, 1.0, 1.0), (1e-9, 1.0, 1.0)]


def graph_in(demo: Demo, unit: float, of_parameter: float, of_rows: float) -> Any:
    """Compute the diagram of a demo in other units, with default settings."""

    def f(v: np.ndarray, q: Any) -> np.ndarray:
        rows = unit if demo.kind == "map" else of_rows
        return rows * np.array(demo.equations(v / unit, q / of_parameter, NUMBERS))

    options = {name: value for name, value in demo.options.items() if name != "scale"}
    start = unit * np.array(demo.u), of_parameter * demo.p
    if demo.kind == "map":
        problem: Any = cv.MapProblem(f, *start, **options)
    else:
        problem = cv.AlgebraicProblem(f, *start, **{"spectrum": "flow", **options})
    low, high = demo.within
    return cv.diagram(problem, within=(low * of_parameter, high * of_parameter), depth=demo.depth)


def differences(demo: Demo, rows: list[dict[str, Any]], units: tuple[float, float, float]) -> list[str]:
    """Return the differences between a diagram in other units and the table."""
    found = [(kind, value / units[1]) for kind, value, _ in points_of(graph_in(demo, *units))]
    width = demo.within[1] - demo.within[0]
    said = []
    for have, row in zip_longest(found, rows):
        want = None if row is None else (row["kind"], row["value"])
        if have is None or want is None or have[0] != want[0]:
            return [f"has {found}, not {[(row['kind'], row['value']) for row in rows]}"]
        if not abs(have[1] - want[1]) <= 1e-10 * abs(want[1]) + 1e-12 * width:
            said.append(f"{have[0]} at {have[1]!r}, not {want[1]!r}")
    return said


def main(names: list[str]) -> None:
    """Compare all demos, or some."""
    expected = json.loads(TABLE.read_text(encoding="utf-8"))
    demos = [*listed.DEMOS, *maps.DEMOS]
    table = json.loads(UNITS.read_text(encoding="utf-8")) if names else {}
    for demo in demos:
        if names and demo.name not in names:
            continue
        alike = 0
        for units in SETS:
            try:
                said = differences(demo, expected[demo.name], units)
            except (ValueError, ArithmeticError) as error:
                said = [f"{type(error).__name__}: {error}"]
            alike += not said
            for sentence in said:
                print(demo.name, units, sentence, flush=True)
        table[demo.name] = alike
    table = {demo.name: table[demo.name] for demo in demos}
    UNITS.write_text(json.dumps(table, indent=0) + "\n", encoding="utf-8")
    print(sum(table.values()), "of", len(SETS) * len(demos), "are the same", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
