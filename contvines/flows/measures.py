"""Names of states and measures of equilibria and cycles, also for solutions that are loaded without the functions of their flow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from . import mesh

if TYPE_CHECKING:
    from .cycle_mesh import CycleMesh
    from .mesh import Rule


OF_STATES = ("max", "min", "mean")  # measures of each state along a cycle
TAKEN = ("norm", "period")  # names of measures, which states cannot have
#: factory in the description of a flow whose functions can be imported; others have none
BUILDER = "contvines.flows.files:from_description"
FINER = 4  # places per node spacing at which the curve is evaluated to find its largest value


def measured(problem: CycleMesh, names: Sequence[str], u: np.ndarray, p: float) -> list[float]:
    """Return the named measures of one cycle."""
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
    """Return the norm of a cycle, or the largest ("max"), smallest ("min") or mean value of its coordinate j.

    Parameters
    ----------
    rule : Rule
    ends : ndarray, shape (N, m + 1, d)
        Values at all nodes of each interval, both ends included.
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
def _interpolation(degree: int) -> np.ndarray:
    """Interpolation matrix from the nodes to equidistant places of an interval."""
    return mesh.rule(degree).interpolation(np.linspace(0.0, 1.0, FINER * degree + 1))


def _largest(rule: Rule, ends: np.ndarray, widths: np.ndarray) -> float:
    """The largest value of a periodic piecewise polynomial: vertex of the parabola through the largest of many values and its neighbours."""
    values = (ends @ _interpolation(rule.degree).T)[:, :-1]
    steps, values = np.repeat(widths / values.shape[1], values.shape[1]), values.reshape(-1)
    k = int(np.argmax(values))
    before, after, middle = steps[k - 1], steps[k], values[k]
    rises, falls = (middle - values[k - 1]) / before, (values[(k + 1) % len(values)] - middle) / after
    bend, slope = (falls - rises) / (before + after), (rises * after + falls * before) / (before + after)
    return float(middle - 0.25 * slope * slope / bend if bend < 0.0 else middle)


def checked_names(given: Sequence[str] | None, count: int) -> tuple[str, ...]:
    """Return the names of `count` states: the given ones, or x0, x1, ...

    Raises
    ------
    ValueError
        If their number is wrong, or a name cannot be used.
    """
    if given is None:
        return tuple(f"x{j}" for j in range(count))
    if isinstance(given, str) or not all(isinstance(name, str) and name.isidentifier() for name in given):
        raise ValueError(f"states = {given!r} must be names, for example ('x', 'y')")
    if len(given) != count:
        raise ValueError(f"states = {tuple(given)!r} has {len(given)} names; the flow has {count} states")
    wrong = next((name for k, name in enumerate(given) if name in (*given[:k], *TAKEN)), None)
    if wrong is not None:
        reason = "is that of a measure" if wrong in TAKEN else "is there twice"
        raise ValueError(f"states: the name {wrong!r} {reason}; choose another one")
    return tuple(given)


@dataclass(frozen=True)
class MeasuresWithoutRates:
    """Measures of equilibria or cycles of a flow that was loaded without its functions.

    Attributes
    ----------
    states : tuple of str
    rule : Rule
    intervals : int
        Mesh intervals of cycles; 0 for equilibria.
    """

    states: tuple[str, ...]
    rule: Rule
    intervals: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the measures: those of the flow itself without the user's outputs."""
        each = tuple(f"{kind} {state}" for kind in OF_STATES for state in self.states)
        if self.intervals:
            return "norm", "period", *each
        unknowns = tuple(f"u{j}" for j in range(len(self.states)))
        return "norm", *unknowns, *self.states, *each, "period"

    def __call__(self, name: str, u: np.ndarray) -> np.ndarray:
        """Return a measure, shape (n,), of solutions u of shape (n, N)."""
        word, _, state = name.rpartition(" ")
        if not self.intervals:
            if name in ("norm", "period"):
                return np.linalg.norm(u, axis=1) if name == "norm" else np.full(len(u), np.nan)
            return u[:, self.states.index(state) if state in self.states else int(name[1:])].copy()
        n, m, d = self.intervals, self.rule.degree, len(self.states)
        if name == "period":  # the period of a forced flow is not an unknown
            free = u.shape[1] > n * m * d + n
            return u[:, n * m * d].copy() if free else np.full(len(u), np.nan)
        j = self.states.index(state) if word else 0
        ends = mesh.closed(u[:, : n * m * d].reshape(-1, n, m, d))
        found = [of_mesh(self.rule, *each, word or name, j) for each in zip(ends, u[:, -n:], strict=True)]
        return np.array(found)


def measures_without_rates(description: Mapping[str, Any], unknowns: int) -> MeasuresWithoutRates | None:
    """Return the measures of solutions with `unknowns` unknowns of a described problem; None if the problem is not one of a flow."""
    flow, cycle = description.get("flow"), description.get("cycle")
    if not isinstance(flow, Mapping) or description.get("factory") not in (None, BUILDER):
        return None
    states, rule = checked_names(flow["states"], len(flow["x0"])), mesh.rule(flow["degree"])
    count = 0 if cycle is None else cycle["intervals"]
    whole = count * (rule.degree * len(states) + 1)
    matches = unknowns in (whole, whole + 1) if count else unknowns == len(states)
    return MeasuresWithoutRates(states, rule, count) if matches else None
