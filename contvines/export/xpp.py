"""A graph as a diagram of XPPAUT: the points that its window "AUTO" writes with `Write pts`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .columns import measures_of

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from ..graph.graph import Graph


def write_xpp(graph: Graph, path: Path) -> None:
    """Write a row per point: parameter, largest and smallest value, type, number of the branch.

    The value is the first state of a flow, the first measure of any other motion. Types are those of XPPAUT: 1 and 2 for stable and
    unstable equilibria, 3 and 4 for stable and unstable motions in time.
    """
    rows = []
    for number, branch in enumerate(graph.branches.values(), 1):
        high, low = _ends(branch)
        cycles = branch.description.get("word", "equilibrium") != "equilibrium"
        stable = np.zeros(len(branch), dtype=bool) if branch.stable is None else np.asarray(branch.stable)
        for k, value in enumerate(branch.values):
            kind = (3 if cycles else 1) + (not stable[k])
            rows.append(f"{value:.15g} {high[k]:.15g} {low[k]:.15g} {kind} {number}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def _ends(branch: Branch) -> tuple[np.ndarray, np.ndarray]:
    """Largest and smallest value of what is shown, each of shape (n,)."""
    measures = measures_of(branch)
    names = [name.removeprefix("max ") for name in measures if name.startswith("max ")]
    state = next((name for name in names if f"min {name}" in measures), None)
    if state is not None:
        return measures[f"max {state}"], measures[f"min {state}"]
    shown = next((name for name in measures if name not in ("norm", "period")), None)
    values = measures[shown] if shown else np.linalg.norm(branch.points, axis=1)
    return values, values
