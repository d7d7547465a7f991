"""What is measured on cycles of flows: largest and smallest values of the coordinates, norm, period."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from . import mesh
from .collocation import rule as rule_of

if TYPE_CHECKING:
    from .collocation import Rule
    from .cycle_mesh import CycleMesh

FINER = 4  # places between two nodes at which the largest value is looked for


def measured(problem: CycleMesh, names: Sequence[str], u: np.ndarray, p: float) -> list[float]:
    """Measures of one cycle, in the order of their names."""
    x, period, widths = problem.parts(u, p)
    ends = mesh.closed(x)
    result = []
    for name in names:
        if name in problem.flow.own_measures:
            result.append(problem.flow.measure_own(name, problem, u, p))
            continue
        word, j = problem.flow.of_states.get(name, (name, 0))
        result.append(float(period) if word == "period" else of_mesh(problem.rule, ends, widths, word, j))
    return result


def of_mesh(rule: Rule, ends: np.ndarray, widths: np.ndarray, word: str, j: int) -> float:
    """The norm of a cycle, or the largest ("max"), smallest ("min") or mean value of its coordinate j.

    Parameters
    ----------
    rule : Rule
    ends : ndarray, shape (N, m + 1, d)
        Values at the nodes of the intervals, with both ends.
    widths : ndarray, shape (N,)
    word : {"norm", "max", "min", "mean"}
    j : int
    """
    if word in ("norm", "mean"):
        points, share = np.einsum("cj,ijk->ick", rule.values, ends), widths[:, None] * rule.weights
        if word == "mean":
            return float((share * points[:, :, j]).sum())
        return float(np.sqrt((share * (points**2).sum(axis=2)).sum()))
    sign = 1.0 if word == "max" else -1.0
    return sign * _largest(rule, sign * ends[:, :, j], widths)


@cache
def _between(degree: int) -> np.ndarray:
    """Matrix from values at the nodes to values at many places in an interval."""
    return rule_of(degree).interpolation(np.linspace(0.0, 1.0, FINER * degree + 1))


def _largest(rule: Rule, ends: np.ndarray, widths: np.ndarray) -> float:
    """The largest value of a piecewise polynomial, from a parabola through the largest of many of its values and those beside it."""
    values = (ends @ _between(rule.degree).T)[:, :-1]
    steps, values = np.repeat(widths / values.shape[1], values.shape[1]), values.reshape(-1)
    k = int(np.argmax(values))
    before, after, middle = steps[k - 1], steps[k], values[k]
    rises, falls = (middle - values[k - 1]) / before, (values[(k + 1) % len(values)] - middle) / after
    bend, slope = (falls - rises) / (before + after), (rises * after + falls * before) / (before + after)
    return float(middle - 0.25 * slope * slope / bend if bend < 0.0 else middle)
