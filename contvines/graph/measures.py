"""Measures of a graph's branches: the one to show, and whether there are numbers to show."""

from __future__ import annotations

from typing import Any

import numpy as np

from .graph import Graph


def default_measure(graph: Graph) -> str:
    """The measure on the y axis when none is named: one that is a number on some branch, at least.

    Motions without impacts have no velocity B there; where none of the graph has, the largest |w| is shown.
    """
    for branch in graph.branches.values():
        names = list(getattr(branch.problem, "measure_names", ()) or ())
        if not names:
            continue
        wanted = getattr(branch.problem, "default_measure", None)
        others = [n for n in names if n not in ("norm", graph.parameter)]
        choice = [n for n in (wanted, "max_abs_w", *others) if n in names]
        return next((str(n) for n in choice if _shown(graph, n)), choice[0] if choice else names[0])
    return "norm"


def measured(branch: Any, name: str) -> np.ndarray:
    """A measure along a branch, shape (n,); what cannot be had is refused with the names that can.

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
            f"{branch.label} has no measure {name!r}; choose one of {', '.join(names)}."
        ) from error


def _shown(graph: Graph, name: str) -> bool:
    return any(has_numbers(b, graph.parameter, name) for b in graph.branches.values() if len(b))


def has_numbers(branch: Any, x: str, y: str) -> bool:
    """Whether some point of a branch has both measures."""
    return bool(np.any(np.isfinite(measured(branch, x)) & np.isfinite(measured(branch, y))))
