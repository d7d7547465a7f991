"""Where two loci cross in the plane without anything to do with one another: two motions, or two directions of one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.engine import Engine
from ..continuation.settings import Settings
from .locus import Locus
from .settings import PLACES

if TYPE_CHECKING:
    from .chart import Chart

Met = tuple[str, str, int, int, np.ndarray]  # two loci, a segment of each, and where these meet


def crossings(chart: Chart, each: Callable[[list[Met]], Iterable[Met]] = iter) -> list[dict[str, Any]]:
    """The crossings of the real parts of a chart's loci.

    Parameters
    ----------
    chart : Chart
    each : callable
        Hands out what may be a crossing one by one, and may tell of it.

    Returns
    -------
    list of dict
        "on", the labels of the two loci; "value", both parameters by name; "error", the uncertainty of the place relative to the plane.
    """
    lows = np.array([interval[0] for interval in chart.within])
    widths = np.array([interval[1] - interval[0] for interval in chart.within])
    curves = {label: (locus.values - lows) / widths for label, locus in chart.loci.items()}
    met: list[Met] = []
    for one, other in combinations(chart.loci, 2):
        real, others = chart.loci[one].real, chart.loci[other].real
        met += [
            (one, other, i, j, lows + place * widths)
            for i, j, place in segments(curves[one], curves[other])
            if real[i : i + 2].all() and others[j : j + 2].all()
        ]
    found: list[dict[str, Any]] = []
    for one, other, i, j, place in each(met):
        p, q, error = _solved(chart.loci[one], chart.loci[other], i, j, place)
        meetings = [p.value for p in chart.points.values() if one in p.on and other in p.on]
        if any(np.abs((np.array([p, q]) - m) / widths).max() < max(PLACES.end, error) for m in meetings):
            continue
        found.append(
            {"on": [one, other], "value": dict(zip(chart.parameters, (p, q))), "error": float(error)}
        )
    return found


def segments(a: np.ndarray, b: np.ndarray) -> list[tuple[int, int, np.ndarray]]:
    """Crossings of two polygons, shapes (n, 2) and (m, 2): (segment of a, segment of b, place)."""
    if len(a) < 2 or len(b) < 2:
        return []
    d, e = np.diff(a, axis=0), np.diff(b, axis=0)
    gap = b[None, :-1] - a[:-1, None]
    turn = d[:, None, 0] * e[None, :, 1] - d[:, None, 1] * e[None, :, 0]
    with np.errstate(all="ignore"):
        s = (gap[..., 0] * e[None, :, 1] - gap[..., 1] * e[None, :, 0]) / turn
        t = (gap[..., 0] * d[:, None, 1] - gap[..., 1] * d[:, None, 0]) / turn
        inside = (s >= 0.0) & (s < 1.0) & (t >= 0.0) & (t < 1.0)
    return [(int(i), int(j), a[i] + s[i, j] * d[i]) for i, j in np.argwhere(inside)]


def _solved(first: Locus, second: Locus, i: int, j: int, place: np.ndarray) -> tuple[float, float, float]:
    """(p, q, error): the place by the secant method on the second parameter, where both loci can be solved at a value of it."""
    low, high = first.within
    width = high - low
    p, q = float(place[0]), float(place[1])
    size = max(
        abs(np.diff(first.branch.values[i : i + 2])[0]), abs(np.diff(second.branch.values[j : j + 2])[0])
    )
    problems = first.problem, second.problem
    if problems[0] is None or problems[1] is None:
        return p, q, float(size / width)
    engines = [Engine(problem, (low, high), Settings()) for problem in (problems[0], problems[1])]

    def gap(value: float) -> tuple[float, float] | None:
        ends = []
        for locus, engine, k in zip((first, second), engines, (i, j)):
            a, b = locus.branch.values[k : k + 2]
            share = 0.5 if a == b else (value - a) / (b - a)
            guess = (1.0 - share) * locus.branch.points[k] + share * locus.branch.points[k + 1]
            solved = engine.at_value(guess, value)
            if solved is None:
                return None
            ends.append(float(solved.u[locus.size]))
        return ends[0] - ends[1], ends[0]

    before, now = q, q + Settings.aside * size + Settings.located * width
    last = gap(before)
    for _ in range(20):
        here = gap(now)
        if last is None or here is None or here[0] == last[0]:
            break
        step = -here[0] * (now - before) / (here[0] - last[0])
        if not abs(now + step - q) <= 2.0 * size:
            break
        before, last, now = now, here, now + step
        if abs(step) < Settings.rounding * width:
            return here[1], float(now), float(abs(step) / width)
    return p, q, float(size / width)
