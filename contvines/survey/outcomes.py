"""What comes out of a diagram, as numbers.

An outcome is a function ``(found: Findings) -> {column: number}``. A *response* is the measure that a diagram shows, along the stable
branches that are no virtual ones, and of motions that were simulated; several may coexist at one value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

GRID = 401  # values at which coexisting responses are compared


@dataclass(frozen=True)
class Findings:
    """What is known of one system.

    Attributes
    ----------
    graph : Graph
        Its diagram.
    seed : object
        The solution that the diagram began with (of a machine: an orbit, its machine in `model`).
    simulated : sequence of (float, dict, str)
        Motions that a simulation settled on: value of the parameter, measures by name, word; see `Job`.
    """

    graph: Any
    seed: Any
    simulated: Sequence[tuple[float, Mapping[str, float], str]] = ()


Outcome = Callable[[Findings], Mapping[str, float]]


@dataclass(frozen=True)
class Stretch:
    """A stable piece of a branch on which the parameter runs one way.

    Attributes
    ----------
    branch : Branch
    first, last : int
        Inclusive indices.
    values, response : float array
    """

    branch: Any
    first: int
    last: int
    values: np.ndarray
    response: np.ndarray


def stretches(graph: Any, measure: str | None = None) -> list[Stretch]:
    """The stable responses of a diagram; `measure` is that of the picture by default."""
    from ..graph.measures import default_measure

    name = measure or default_measure(graph)
    found = []
    for branch in graph.branches.values():
        if not branch.real or not len(branch):
            continue
        response = np.asarray(branch.measure(name), dtype=float)
        for first, last, stable in branch.pieces():
            if not stable:
                continue
            steps = np.sign(np.diff(branch.values[first : last + 1]))
            turns = [first, *(first + 1 + np.flatnonzero(steps[1:] * steps[:-1] < 0.0)).tolist(), last]
            for a, b in pairwise(turns):
                part = slice(a, b + 1)
                found.append(Stretch(branch, a, b, branch.values[part], response[part]))
    return found


def highest(stretch: Stretch) -> tuple[float, float, int]:
    """The largest response on a stretch, where, and the index of the nearest point.

    Between the points the response is a cubic spline over the length along the curve.
    """
    from scipy.interpolate import CubicSpline

    values, response = stretch.values, stretch.response
    if not np.any(np.isfinite(response)):
        return -np.inf, np.nan, stretch.first
    top = int(np.nanargmax(response))
    best = float(response[top]), float(values[top])
    a, b = max(top - 2, 0), min(top + 3, len(values))
    if b - a >= 4 and 0 < top < len(values) - 1 and np.all(np.isfinite(response[a:b])):
        x, y = values[a:b], response[a:b]
        steps = np.hypot(np.diff(x) / (np.ptp(x) or 1.0), np.diff(y) / (np.ptp(y) or 1.0))
        if np.all(steps > 0.0):
            along = np.concatenate([[0.0], np.cumsum(steps)])
            curve, place = CubicSpline(along, y), CubicSpline(along, x)
            roots = [t for t in curve.derivative().roots(extrapolate=False) if along[0] <= t <= along[-1]]
            top_t = max(roots, key=lambda t: float(curve(t)), default=None)
            if top_t is not None and float(curve(top_t)) > best[0]:
                best = float(curve(top_t)), float(place(top_t))
    return best[0], best[1], stretch.first + top


def peak(found: Findings) -> dict[str, float]:
    """The largest response, over all that coexist, and where it is."""
    from ..graph.measures import default_measure

    name = default_measure(found.graph)
    known = [highest(stretch)[:2] for stretch in stretches(found.graph)]
    known += [(float(measures.get(name, np.nan)), value) for value, measures, _ in found.simulated]
    value, place = max((pair for pair in known if np.isfinite(pair[0])), default=(np.nan, np.nan))
    return {"peak": value, "peak_at": place}


def lower_peak(found: Findings) -> dict[str, float]:
    """The same where at each value the lowest of the coexisting responses of the diagram is met."""
    grid, table = _compared(found.graph)
    known = np.any(np.isfinite(table), axis=0)
    if not known.any():
        return {"lower_peak": np.nan, "lower_peak_at": np.nan}
    lowest = np.nanmin(table[:, known], axis=0)
    top = int(np.argmax(lowest))
    return {"lower_peak": float(lowest[top]), "lower_peak_at": float(grid[known][top])}


def covered(found: Findings) -> dict[str, float]:
    """Share of the interval in which the diagram has a stable response."""
    low, high = found.graph.within
    return {"covered": 1.0 - sum(b - a for a, b in gaps(found.graph)) / (high - low)}


def gaps(graph: Any) -> list[tuple[float, float]]:
    """Intervals of the parameter in which the diagram has no stable response."""
    found, reached = [], graph.within[0]
    spans = sorted((s.values.min(), s.values.max()) for s in stretches(graph))
    for low, high in spans:
        if low > reached:
            found.append((float(reached), float(low)))
        reached = max(reached, high)
    if reached < graph.within[1]:
        found.append((float(reached), float(graph.within[1])))
    return found


def activation(found: Findings) -> dict[str, float]:
    """Where impacts begin.

    From below: the value up to which a motion without impacts is stable. From above: the least value at which one with impacts is. Both
    are special points of the diagram; no number where the interval ends first, where the diagram has no motion without impacts (it
    may then lack the branch that begins where they do), or where a simulation contradicts it.
    """
    low, high = found.graph.within
    known = stretches(found.graph)
    calm = [s for s in known if not s.branch.description.get("impacts")]
    busy = [s for s in known if s.branch.description.get("impacts")]
    above = max((float(s.values.max()) for s in calm), default=np.nan)
    below = min((float(s.values.min()) for s in busy), default=np.nan)
    told = [
        (value, measures["impacts_per_period"])
        for value, measures, _ in found.simulated
        if "impacts_per_period" in measures
    ]
    beyond = any(not impacts and value > above for value, impacts in told)
    before = any(impacts and value < below for value, impacts in told)
    return {
        "activation_from_below": above if above < high and not beyond else np.nan,
        "activation_from_above": below if below > low and calm and not before else np.nan,
    }


def stable_range(found: Findings, word: str) -> dict[str, float]:
    """Where the motion with this word is stable: the length that is, from, and to."""
    parts = [
        interval
        for branch in found.graph.branches.values()
        if branch.real and branch.description.get("word") == word
        for interval in branch.stable_intervals()
    ]
    ends = (min(a for a, _ in parts), max(b for _, b in parts)) if parts else (np.nan, np.nan)
    length = sum(b - a for a, b in _united(parts))
    return {f"stable_{word}": length, f"stable_{word}_from": ends[0], f"stable_{word}_to": ends[1]}


def first_point(found: Findings, kind: str) -> dict[str, float]:
    """The least value with a special point of this kind on a branch that is no virtual one."""
    values = [float(point.value) for point in found.graph.of_kind(kind) if point.real]
    return {f"first_{kind}": min(values, default=np.nan)}


def _united(parts: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Overlapping intervals joined."""
    joined: list[tuple[float, float]] = []
    for low, high in sorted(parts):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return joined


def _compared(graph: Any) -> tuple[np.ndarray, np.ndarray]:
    """Values, shape (n,), and the responses of all stretches there, shape (m, n); no number beyond a stretch's ends."""
    grid = np.linspace(graph.within[0], graph.within[1], GRID)
    rows = []
    for stretch in stretches(graph):
        order = np.argsort(stretch.values, kind="stable")
        rows.append(
            np.interp(grid, stretch.values[order], stretch.response[order], left=np.nan, right=np.nan)
        )
    return grid, np.array(rows).reshape(len(rows), GRID)


def coexisting(found: Findings) -> dict[str, float]:
    """The largest number of stable responses at one value, and the share of the interval in which there is more than one."""
    count = np.isfinite(_compared(found.graph)[1]).sum(axis=0)
    return {
        "coexisting": float(count.max(initial=0)),
        "ambiguous": float(np.mean(count > 1)) if count.size else np.nan,
    }


def share(found: Findings, word: str) -> dict[str, float]:
    """Share of the simulated starts that settle on the motion with this word.

    Of an atlas: the mean over the values with the most starts, and the least of them. Else of all motions that were simulated.
    """
    met = found.graph.attractors
    if met:
        most = max(attractor.starts for attractor in met)
        by_value: dict[float, float] = {}
        for attractor in met:
            if attractor.starts == most:
                own = attractor.share if attractor.word == word else 0.0
                by_value[attractor.value] = by_value.get(attractor.value, 0.0) + own
        shares = list(by_value.values())
        return {f"share_{word}": float(np.mean(shares)), f"share_{word}_least": min(shares)}
    words = [name for _, _, name in found.simulated]
    return {f"share_{word}": words.count(word) / len(words) if words else np.nan}


PLAIN: dict[str, Outcome] = {
    "peak": peak,
    "lower_peak": lower_peak,
    "covered": covered,
    "activation": activation,
    "coexisting": coexisting,
}
"""Outcomes by name."""
MADE: dict[str, Callable[..., Mapping[str, float]]] = {
    "stable": stable_range,
    "first": first_point,
    "share": share,
}
"""Outcomes of a word or kind, written ``stable:LR``, ``first:period-doubling``."""
ARGUMENTS = {"stable": "word", "first": "kind", "share": "word"}
"""What follows the colon, as the functions call it."""
