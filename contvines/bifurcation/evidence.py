"""Evidence: numbers at the points of a branch from which special points between them are detected.

* `sides` are signs and counts. If one of them differs at the two ends of a segment, a special point lies between.
* `distances` are values of test functions. One of them may reach zero inside a segment and return, with equal signs at both ends: a dip. The
  parabola through three neighbouring points shows whether a dip is possible; points inside the segment then decide. For multipliers
  :func:`contvines.bifurcation.scan.reached` does this.
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

PLACES, ZOOMS = np.linspace(0.0, 1.0, 9), 8  # positions at which a kink is sought; number of zooms towards it
LINE_REACH = 1.5  # a straight line continued into a segment must reach zero within this many of its lengths
EDGE = 0.9  # the same for the first and last segment of a chunk, which have a neighbour on one side only


class Evidence(NamedTuple):
    """Evidence at n points.

    Attributes
    ----------
    sides : ndarray of int, shape (n, k)
        Sign of the parameter's component of the tangent, sign of the bordered determinant, numbers of multipliers outside the unit circle, signs of
        user-defined tests; 0 where a number is only rounding.
    distances : ndarray, shape (n, j)
        Numbers that are zero at special points: the parameter's component of the tangent, user-defined tests, the smallest margin.
    margins : ndarray, shape (n, w)
        All margins. Columns of `distance` count those of ``distances`` first, then these.
    """

    sides: np.ndarray
    distances: np.ndarray
    margins: np.ndarray

    @property
    def first_margin(self) -> int:
        """Column of the first margin, as `distance` counts columns."""
        return self.distances.shape[1]

    @property
    def outside(self) -> np.ndarray:
        """Whether a margin is negative, shape (n,)."""
        return self.distances[:, -1] < 0.0

    def distance(self, column: int) -> np.ndarray:
        """Return a column of ``distances``, or the distance of a margin from its border, at all points, shape (n,)."""
        first = self.first_margin
        return self.distances[:, column] if column < first else self.margins[:, column - first] - MARGIN


def evidence(engine: Engine, chunk: Chunk, tests: Sequence[Own], scanned: Scan | None = None) -> Evidence:
    """Return the evidence at the points of a chunk.

    Parameters
    ----------
    engine : Engine
    chunk : Chunk
    tests : sequence of Own
        User-defined tests.
    scanned : Scan, optional
        Scan of the chunk, if it has been computed already.
    """
    rows, slopes = chunk.rows, chunk.tangents[:, -1]
    user_values = np.array([test.values(chunk) for test in tests]).reshape(len(tests), len(chunk))
    smallest = engine.smallest_margin(rows) if scanned is None else scanned.smallest
    past = spectra(engine, rows).past if scanned is None else scanned.spectra.past
    directions = np.where(np.abs(slopes) > engine.upright(float(chunk.values[0])), np.sign(slopes), 0.0)
    balances = [balance(engine, rows)] if engine.exchanges else []
    sides = [
        directions,
        np.sign(chunk.signs),
        *(past + 1),
        *(np.where(values >= 0.0, 1, -1) for values in (*user_values, *balances)),
    ]
    distances = [np.where(directions != 0.0, slopes, np.nan), *user_values, smallest - MARGIN]
    return Evidence(np.column_stack(sides).astype(int), np.column_stack(distances), rows[:, 2 * engine.m :])


def fill_zeros(sides: np.ndarray) -> np.ndarray:
    """Replace each 0 in `sides`, shape (n, k), by the last nonzero side before it; at the beginning, by the first nonzero side."""
    nonzero = sides != 0
    if nonzero.all():
        return sides
    places = np.where(nonzero, np.arange(len(sides))[:, None], -1)
    last = np.maximum.accumulate(places, axis=0)
    return np.take_along_axis(sides, np.where(last < 0, nonzero.argmax(axis=0), last), axis=0)


def possible_dips(observed: Evidence, scan: Scan) -> tuple[np.ndarray, np.ndarray]:
    """Find the segments on which a distance may dip to zero: the parabola through three neighbouring values of one sign crosses zero.

    Returns
    -------
    columns : ndarray of int, shape (j,)
        Tested columns, as `Evidence.distance` counts them: all of ``distances``, then the margins for which the scan does not exclude a dip.
    found : ndarray of bool, shape (n - 1, j)
        Whether the distance may dip to zero on the segment.
    """
    first, lengths, low = observed.first_margin, scan.lengths, np.flatnonzero(scan.low)
    columns = np.append(np.arange(first), first + low)
    found = np.zeros((len(lengths), len(columns)), dtype=bool)
    if len(lengths) > 1:
        values = np.hstack([observed.distances, observed.margins[:, low] - MARGIN])
        left, middle, right = np.array([values[:-2], values[1:-1], values[2:]]) * np.sign(values[1:-1])
        dips = parabola_dips(left, middle, right, lengths[:-1, None], lengths[1:, None])
        found[:-1] |= dips
        found[1:] |= dips
    return columns, found


def kinks(distances: np.ndarray, signs: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Find the segments with equal signs at both ends in which straight lines through the neighbouring values, from both sides, reach zero.

    Two eigenvalues may cross zero there at once; for problems with many unknowns only the eigenvalue nearest to zero is known along the branch.

    Parameters
    ----------
    distances : ndarray, shape (n,)
        Positive distances of the nearest multiplier or eigenvalue.
    signs : ndarray, shape (n,)
        Signs of the bordered determinant.
    lengths : ndarray, shape (n - 1,)
        Lengths of the segments.

    Returns
    -------
    ndarray of bool, shape (n - 1,)
    """
    changes = np.diff(distances)
    with np.errstate(all="ignore"):
        ahead = np.where(changes < 0.0, -distances[1:] / changes, np.inf) * lengths
        back = np.where(changes > 0.0, distances[:-1] / changes, np.inf) * lengths
    # the first and the last segment of a chunk have one neighbour only: its line must reach zero well inside
    before, behind = np.append(np.inf, ahead[:-1]) / lengths, np.append(back[1:], np.inf) / lengths
    inside = (before < LINE_REACH) & (behind < LINE_REACH)
    if len(lengths) > 1:
        inside[0], inside[-1] = behind[0] < EDGE, before[-1] < EDGE
    return (signs[:-1] == signs[1:]) & inside


def may_be_real(observed: Evidence, lengths: np.ndarray) -> np.ndarray:
    """Find the segments of a virtual branch that may be real inside although both ends are virtual, shape (n - 1,); a single segment always may.

    A margin that is negative at both ends can be positive between only where two straight lines are positive: through the two points before the
    segment and through the two points behind it. The margin lies below these lines if it bends downwards, or is shaped like a roof (the
    reserve of friction).
    """
    margins, lengths = observed.margins - MARGIN, lengths[:, None]
    negative = (margins[:-1] < 0.0) & (margins[1:] < 0.0)
    rises, falls = (
        np.full(negative.shape, np.inf),
        np.full(negative.shape, -np.inf),
    )  # the interval of the segment in which both lines are positive
    if len(lengths) > 1:
        rises[0], falls[-1] = 0.0, lengths[-1]
        with np.errstate(all="ignore"):
            slopes, inner = np.diff(margins, axis=0) / lengths, margins[1:-1]
            rises[1:] = np.where(slopes[:-1] > 0.0, -inner / slopes[:-1], np.inf)
            falls[:-1] = np.where(slopes[1:] < 0.0, lengths[:-1] - inner / slopes[1:], -np.inf)
    possible = (rises < falls) & (rises < lengths) & (falls > 0.0)
    return observed.outside[:-1] & observed.outside[1:] & (possible | ~negative).all(axis=1)


# ------------------------------------------------------------------ kinks
def nearest(engine: Engine, rows: np.ndarray, spectra: Spectra | None = None) -> np.ndarray:
    """Return the distance of the real multiplier nearest to +1 (of eigenvalues: nearest to zero, complex pairs included), shape (n,).

    `spectra` of the same rows saves the computation; it is NaN for a multiplier on the circle to rounding.
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


def has_kink(segment: Segment) -> bool:
    """Whether the distance of the nearest real multiplier from the circle has a kink at zero within a segment: its sides stay as steep at every zoom.

    On one branch a multiplier touches the circle along a parabola. If its distance falls to zero in a straight line and no count changes, a step
    has jumped from one branch to another through the point where they cross. Both branches have equally many unstable multipliers, and unknowns of
    very different sizes can hide the corner from the step rule, which compares tangents (example: x (2 p + 3 x^2 + 3) = 0 beside unknowns
    hundreds of times as large).

    Returns False for cycles on a mesh if both ends are next to the circle, for example where a branch turns round at a cycle of half the period.
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
                return False  # a kink could be rounding
            first = steepness
        elif steepness < engine.settings.steep * first:
            return False
        low, high = float(places[k - 1]), float(places[k + 1])
    return True
