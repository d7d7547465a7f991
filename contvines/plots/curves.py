"""Branches as curves of a picture: broken where an angle jumps by a turn, refined where corners would be visible."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..branches import Branch

CORNER = 0.06  # radians: angle between neighbouring segments on the page from which on a corner is visible
SHORT = 4.0  # pixels: shorter segments are not refined
MOST = 40  # largest number of points inserted between two neighbours


class Curve:
    """The points `first` to `last` (inclusive) of a branch, drawn as measure y over measure x: one line, or one per point of a cycle of a map."""

    def __init__(self, branch: Branch, x: str, y: str, first: int, last: int) -> None:
        self.branch, self.x, self.y = branch, x, y
        self.first, self.last = first, last
        angles = () if branch.problem is None else branch.problem.angles  # radians, modulo 2 pi
        self.turning = (x in angles, y in angles)
        self.lines: list[Line2D] = []
        part = slice(first, last + 1)
        self._stored = _strands(branch, x, y, branch.points[part], branch.values[part])

    def draw(self, axes: Axes, style: Mapping[str, Any]) -> None:
        """Draw lines through the stored points; `style`: arguments of `Axes.plot`."""
        self.lines = [axes.plot(*broken(xs, ys, self.turning), **style)[0] for xs, ys in self._stored]

    def refine(self, axes: Axes) -> None:
        """Insert points between the stored ones where the line has visible corners, for the present limits of the axes."""
        strands = self._stored
        if len(strands[0][0]) < 3:
            return
        wanted = np.max([_insertions(axes, xs, ys) for xs, ys in strands], axis=0)
        drawn = strands
        if wanted.any():
            u, p, inside = between(self.branch, self.first, self.last, wanted)
            try:
                new = _strands(self.branch, self.x, self.y, u, p)
            except (KeyError, ValueError, ArithmeticError):
                return
            drawn = []
            for (xs, ys), found in zip(strands, new, strict=True):
                nx, ny = (np.array(part) for part in found)
                nx[~inside], ny[~inside] = xs, ys  # stored points keep their values
                good = np.isfinite(nx) & np.isfinite(ny) | ~inside
                drawn.append((nx[good], ny[good]))
        for line, (xs, ys) in zip(self.lines, drawn, strict=True):
            line.set_data(*broken(xs, ys, self.turning))


def broken(xs: np.ndarray, ys: np.ndarray, turning: tuple[bool, bool]) -> tuple[np.ndarray, np.ndarray]:
    """Return a curve with a gap (nan) wherever an angle jumps by more than half a turn between neighbouring points."""
    jumps = np.zeros(max(len(xs) - 1, 0), dtype=bool)
    for values, angle in zip((xs, ys), turning):
        if angle:
            jumps |= np.abs(np.diff(values)) > np.pi
    where = np.flatnonzero(jumps) + 1
    return np.insert(xs, where, np.nan), np.insert(ys, where, np.nan)


def between(
    branch: Branch, first: int, last: int, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points `first` to `last` (inclusive) of a branch with further ones between them, on cubics given by points and tangents.

    `counts`, shape (last - first,), is the number of points to be inserted after each point. Result: u (m, N), p (m,), and the mask (m,) of the
    inserted points.
    """
    z = np.column_stack([branch.points, branch.values])[first : last + 1]
    slopes, chord = np.asarray(branch.tangents[first : last + 1], dtype=float), np.diff(z, axis=0)
    length = np.linalg.norm(chord, axis=1)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = slopes / np.linalg.norm(slopes, axis=1)[:, None]
    # a straight line where a tangent deviates much from the chord: at a kink, or where the order of the points is reversed
    along = [np.sum(way * chord, axis=1, keepdims=True) for way in (ways[:-1], ways[1:])]
    start, end = (
        np.where(np.minimum(*along) > 0.3 * length, length * way, chord) for way in (ways[:-1], ways[1:])
    )
    i = np.repeat(np.arange(len(counts)), counts)
    s = np.concatenate([np.arange(1, n + 1) / (n + 1) for n in counts])[:, None]
    # cubic Hermite basis on [0, 1]
    new = (1 + 2 * s) * (1 - s) ** 2 * z[i] + s * (1 - s) ** 2 * start[i]
    new += s**2 * (3 - 2 * s) * z[i + 1] + s**2 * (s - 1) * end[i]
    joined = np.insert(z, i + 1, new, axis=0)
    return joined[:, :-1], joined[:, -1], np.insert(np.zeros(len(z), bool), i + 1, True)


def _strands(
    branch: Branch, x: str, y: str, u: np.ndarray, p: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the measures x and y of solutions (u, p), one pair of arrays per line: a single one, or one per point of a cycle."""
    columns = []
    for name in (x, y):
        found = p[:, None] if name == branch.parameter else None
        if found is None and branch.problem is not None:
            found = branch.problem.at_each_point(name, u, p)
        if found is None:
            found = np.asarray(branch.measure_of(name, u, p))[:, None]
        columns.append(np.asarray(found, dtype=float))
    return list(zip(*(column.T for column in np.broadcast_arrays(*columns))))


def _insertions(axes: Axes, xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Return the number of points to be inserted after each point of a line, shape (n - 1,)."""
    page = axes.transData.transform(np.column_stack([xs, ys]))
    steps = np.diff(page, axis=0)
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.abs((np.diff(angle) + np.pi) % (2 * np.pi) - np.pi)
    sharp = np.maximum(np.append(turn, 0.0), np.append(0.0, turn))
    low, high = np.minimum(page[:-1], page[1:]), np.maximum(page[:-1], page[1:])
    seen = np.all((high > axes.bbox.min) & (low < axes.bbox.max), axis=1)
    wanted = (sharp > CORNER) & (np.hypot(*steps.T) > SHORT) & seen
    return np.where(wanted, np.minimum(np.ceil(np.nan_to_num(sharp) / CORNER), MOST), 0).astype(int)
