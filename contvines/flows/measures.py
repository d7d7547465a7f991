"""What is measured on cycles of flows: largest and smallest values of the coordinates, norm, period."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from . import mesh

if TYPE_CHECKING:
    from .collocation import Rule
    from .cycle_mesh import CycleMesh

FINER = 4  # places between two nodes at which the largest value is looked for


def measured(problem: CycleMesh, names: Sequence[str], u: np.ndarray, p: float) -> list[float]:
    """Measures of one cycle, in the order of their names."""
    x, period, widths = problem.parts(u, p)
    ends, r = mesh.closed(x), problem.rule
    points = np.einsum("cj,ijk->ick", r.values, ends)
    share = widths[:, None] * r.weights
    result = []
    for name in names:
        if name in problem.flow.own_measures:
            result.append(problem.flow.measure_own(name, problem, u, p))
            continue
        word, j = problem.flow.of_states.get(name, (name, 0))
        if word == "norm":
            result.append(float(np.sqrt((share * (points**2).sum(axis=2)).sum())))
        elif word == "period":
            result.append(float(period))
        elif word == "mean":
            result.append(float((share * points[:, :, j]).sum()))
        else:
            sign = 1.0 if word == "max" else -1.0
            result.append(sign * _largest(r, sign * ends[:, :, j]))
    return result


def _largest(rule: Rule, ends: np.ndarray) -> float:
    """The largest value of a piecewise polynomial, from a parabola through the largest of many of its values."""
    places = np.linspace(0.0, 1.0, FINER * rule.degree + 1)
    values = ends @ rule.interpolation(places).T
    i, j = np.unravel_index(int(np.argmax(values)), values.shape)
    j = int(np.clip(j, 1, len(places) - 2))
    left, middle, right = values[i, j - 1 : j + 2]
    bend = left - 2.0 * middle + right
    if not bend < 0.0:
        return float(values.max())
    top = middle - (right - left) ** 2 / (8.0 * bend)
    inside = abs(right - left) <= -2.0 * bend
    return float(max(top, values.max())) if inside else float(values.max())
