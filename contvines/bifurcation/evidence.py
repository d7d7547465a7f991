"""What points of a branch tell: on which side of special points each of them lies, and how far from these it is.

Where a number of `sides` differs at the two ends of a segment, something lies between. Where none does, one of `distances` may come to
zero between the points and go back: the parabola through three of them says so, and points inside the segment decide. Of multipliers
:func:`contvines.bifurcation.scan.reached` says it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine
from ..continuation.layout import MARGIN, Chunk
from .kind import Own
from .locate import Segment
from .scan import Scan, Spectra, balance, parabola_dips, sizes_by_sort, spectra

PLACES, ZOOMS = np.linspace(0.0, 1.0, 9), 8  # where a kink is looked for, and how many times nearer
AHEAD, EDGE = 1.5, 0.9  # lengths of a segment within which a line may be zero; where only one side tells


class Evidence(NamedTuple):
    """Of n points.

    Attributes
    ----------
    sides : ndarray of int, shape (n, k)
        Direction of the parameter, sign of the bordered determinant, numbers of multipliers past the circle, sides of users' tests; 0
        where nothing tells.
    distances : ndarray, shape (n, j)
        Numbers that pass zero at special points: the parameter's part of the tangent, users' tests, the smallest margin.
    margins : ndarray, shape (n, w)
        All of them, of which the distances follow those in ``distances``.
    """

    sides: np.ndarray
    distances: np.ndarray
    margins: np.ndarray

    @property
    def first_margin(self) -> int:
        """Column of the first margin's distance."""
        return self.distances.shape[1]

    @property
    def outside(self) -> np.ndarray:
        """Whether a margin is negative."""
        return self.distances[:, -1] < 0.0

    def distance(self, column: int) -> np.ndarray:
        """One of the distances, or a margin's, at all points."""
        first = self.first_margin
        return self.distances[:, column] if column < first else self.margins[:, column - first] - MARGIN


def evidence(engine: Engine, chunk: Chunk, tests: Sequence[Own], scanned: Scan | None = None) -> Evidence:
    """What points tell.

    Parameters
    ----------
    engine : Engine
    chunk : Chunk
    tests : sequence of Own
        Of users.
    scanned : Scan, optional
        Of the chunk, where it is known.
    """
    rows, slopes = chunk.rows, chunk.tangents[:, -1]
    own = np.array([test.values(chunk) for test in tests]).reshape(len(tests), len(chunk))
    smallest = engine.smallest_margin(rows) if scanned is None else scanned.smallest
    past = spectra(engine, rows).past if scanned is None else scanned.spectra.past
    directions = np.where(np.abs(slopes) > engine.upright(float(chunk.values[0])), np.sign(slopes), 0.0)
    balances = [balance(engine, rows)] if engine.exchanges else []
    sides = [
        directions,
        np.sign(chunk.signs),
        *(past + 1),
        *(np.where(values >= 0.0, 1, -1) for values in (*own, *balances)),
    ]
    distances = [np.where(directions != 0.0, slopes, np.nan), *own, smallest - MARGIN]
    return Evidence(np.column_stack(sides).astype(int), np.column_stack(distances), rows[:, 2 * engine.m :])


def filled(sides: np.ndarray) -> np.ndarray:
    """Sides, shape (n, k), in which a 0 has taken the side of the point before it; at the beginning that of the first point that has one."""
    known = sides != 0
    if known.all():
        return sides
    places = np.where(known, np.arange(len(sides))[:, None], -1)
    last = np.maximum.accumulate(places, axis=0)
    return np.take_along_axis(sides, np.where(last < 0, known.argmax(axis=0), last), axis=0)


def suspicious(seen: Evidence, scan: Scan) -> tuple[np.ndarray, np.ndarray]:
    """Which distances may come to zero within segments and go back: parabolas through three neighbours of one sign do.

    Returns
    -------
    columns : ndarray of int, shape (j,)
        All distances but margins', then those of margins for which it is not excluded.
    found : ndarray of bool, shape (n - 1, j)
    """
    first, lengths, low = seen.first_margin, scan.lengths, np.flatnonzero(scan.low)
    columns = np.append(np.arange(first), first + low)
    found = np.zeros((len(lengths), len(columns)), dtype=bool)
    if len(lengths) > 1:
        values = np.hstack([seen.distances, seen.margins[:, low] - MARGIN])
        left, middle, right = np.array([values[:-2], values[1:-1], values[2:]]) * np.sign(values[1:-1])
        dips = parabola_dips(left, middle, right, lengths[:-1, None], lengths[1:, None])
        found[:-1] |= dips
        found[1:] |= dips
    return columns, found


def pointed(distances: np.ndarray, signs: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Segments with equal signs at both ends in which distances, continued from before and from behind in straight lines, reach zero.

    Two eigenvalues may pass zero there at once; of problems with many unknowns only the nearest one is known along the branch.

    Parameters
    ----------
    distances : ndarray, shape (n,)
        Positive.
    signs : ndarray, shape (n,)
    lengths : ndarray, shape (n - 1,)
    """
    changes = np.diff(distances)
    with np.errstate(all="ignore"):
        ahead = np.where(changes < 0.0, -distances[1:] / changes, np.inf) * lengths
        back = np.where(changes > 0.0, distances[:-1] / changes, np.inf) * lengths
    # at the ends of a chunk there is only one side to tell: its zero has to lie well inside
    before, behind = np.append(np.inf, ahead[:-1]) / lengths, np.append(back[1:], np.inf) / lengths
    inside = (before < AHEAD) & (behind < AHEAD)
    if len(lengths) > 1:
        inside[0], inside[-1] = behind[0] < EDGE, before[-1] < EDGE
    return (signs[:-1] == signs[1:]) & inside


def may_be_real(seen: Evidence, lengths: np.ndarray) -> np.ndarray:
    """Segments of a virtual branch that may be real inside though both ends are not, shape (n - 1,); of a single one nothing is known.

    A margin that is negative at both ends may be positive in between where the lines through the two points before and through
    the two behind are, which lie above it wherever it bends downwards, or is a roof, as the reserve of friction is.
    """
    margins, lengths = seen.margins - MARGIN, lengths[:, None]
    kept = (margins[:-1] < 0.0) & (margins[1:] < 0.0)
    rises, falls = (
        np.full(kept.shape, np.inf),
        np.full(kept.shape, -np.inf),
    )  # from where to where on a segment
    if len(lengths) > 1:
        rises[0], falls[-1] = 0.0, lengths[-1]
        with np.errstate(all="ignore"):
            slopes, inner = np.diff(margins, axis=0) / lengths, margins[1:-1]
            rises[1:] = np.where(slopes[:-1] > 0.0, -inner / slopes[:-1], np.inf)
            falls[:-1] = np.where(slopes[1:] < 0.0, lengths[:-1] - inner / slopes[1:], -np.inf)
    may = (rises < falls) & (rises < lengths) & (falls > 0.0)
    return seen.outside[:-1] & seen.outside[1:] & (may | ~kept).all(axis=1)


# ------------------------------------------------------------------ kinks
def nearest(engine: Engine, rows: np.ndarray, spectra: Spectra | None = None) -> np.ndarray:
    """Distance of the real multiplier nearest to +1 (of eigenvalues: to zero, pairs included, which pass the axis elsewhere), shape (n,).

    Of points whose multipliers are known to tell something it need not be computed again; on the circle it is NaN there.
    """
    if engine.many:
        return -rows[:, 0]
    if spectra is not None and engine.detection != "real":
        return spectra.near
    with np.errstate(all="ignore"):
        if engine.detection == "real":
            sizes = np.hypot(rows[:, : 2 * engine.m : 2], rows[:, 1 : 2 * engine.m : 2])
        else:
            sizes = np.abs(sizes_by_sort(engine, rows)[0])
        return np.fmin.reduce(sizes, axis=1, initial=np.inf)


def kinked(segment: Segment) -> bool:
    """Whether the real multiplier nearest to the circle has a kink there within a segment: looked at nearer, its sides stay as steep.

    Along a branch a multiplier that touches the circle does so as a parabola. Where it falls to nothing in a straight line, and no count
    changes, a step has led from one branch to another through the point in which they cross: both are unstable alike, and where unknowns of
    very different sizes hide the corner the rule of the loop, which compares tangents, sees none (x (2 p + 3 x^2 + 3) = 0 behind unknowns
    hundreds of times as large).
    Of cycles on a mesh nothing is told where both ends are next to the circle, as where a branch turns round at a cycle of half the period.
    """
    engine, low, high, first = segment.engine, 0.0, 1.0, 0.0
    for zoom in range(ZOOMS):
        places = low + (high - low) * PLACES
        rows, found = segment.rows(places)
        places = places[found]
        if len(places) < 3:
            return False
        near = nearest(engine, rows[found])
        k = int(np.argmin(near[1:-1])) + 1
        steepness = min(near[0], near[-1]) / (high - low)
        if not (np.isfinite(near).all() and near[k] < min(near[0], near[-1])):
            return False
        if zoom == 0:
            if engine.adaptive and max(near[0], near[-1]) <= engine.settings.critical:
                return False  # kinks are those of rounding
            first = steepness
        elif steepness < engine.settings.steep * first:
            return False
        low, high = float(places[k - 1]), float(places[k + 1])
    return True
