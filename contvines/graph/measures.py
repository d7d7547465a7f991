"""What is on the axes of a diagram: measures along branches and at special points, and the one shown when none is named."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.near_names import did_you_mean

if TYPE_CHECKING:
    from ..branches.branch import Branch
    from ..branches.special_point import SpecialPoint
    from .graph import Graph


def default_measure(graph: Graph) -> str:
    """The measure on the y axis when none is named: one that is a number on some branch, at least.

    Motions without impacts have no velocity B there; where none of the graph has, the largest |w| is shown.
    """
    for branch in graph.branches.values():
        known = branch if branch.problem is None else branch.problem
        names, wanted = list(known.measure_names), known.default_measure
        if not names or (branch.problem is None and not wanted):
            continue
        others = [n for n in names if n not in ("norm", graph.parameter)]
        choice = [n for n in (wanted, "max_abs_w", *others) if n in names]
        return next((str(n) for n in choice if _shown(graph, n)), choice[0] if choice else names[0])
    return "norm"


def undrawn(graph: Graph, x: str, y: str) -> str:
    """Which branches have no number to draw, as a line of the legend; empty if all have one."""
    missing = [b for b in graph.branches.values() if len(b) and not _finite(b, x, y)]
    if not missing:
        return ""
    labels = [b.label for b in missing]
    listed = ", ".join(labels) if len(labels) <= 4 else f"{', '.join(labels[:3])} +{len(labels) - 3}"
    still = all(b.description.get("impacts") == 0 for b in missing)
    return f"not drawn: {listed} ({'no impacts' if still else f'no {y} there'})"


def measured(branch: Branch, name: str) -> np.ndarray:
    """A measure along a branch, shape (n,); what cannot be obtained is refused with the names that can.

    Raises
    ------
    ValueError
        If the branch has no such measure.
    """
    try:
        return np.asarray(branch.measure(name), float)
    except (KeyError, ValueError) as error:
        names = sorted({branch.parameter, *branch.measure_names})
        raise ValueError(
            f"{branch.label} has no measure {name!r}{did_you_mean(name, names)}; choose one of {', '.join(names)}."
        ) from error


def _shown(graph: Graph, name: str) -> bool:
    return any(_finite(b, graph.parameter, name) for b in graph.branches.values() if len(b))


def _finite(branch: Branch, x: str, y: str) -> bool:
    """Whether some point of a branch has both measures."""
    return bool(np.any(np.isfinite(measured(branch, x)) & np.isfinite(measured(branch, y))))


def measure_at(branch: Branch, point: SpecialPoint, name: str) -> float:
    if name == branch.parameter:
        return float(point.value)
    if 0 <= point.index < len(branch):
        return float(measured(branch, name)[point.index])
    if branch.problem is None:
        nearest = int(np.argmin(np.abs(branch.points - point.u).max(axis=1)))
        return float(measured(branch, name)[nearest])
    return float(branch.problem.measures((name,), point.u[None, :], np.array([point.value]))[name][0])
