"""What points of a branch tell: on which side of special points each of them lies, and how far from these it is.

Where a number of `sides` differs at the two ends of a segment, something lies between. Where none does, one of `distances` may come to
zero between the points and go back: the parabola through three of them says so, and points inside the segment decide. Of multipliers
:func:`contvines.bifurcation.scan.reached` says it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine
from ..continuation.layout import MARGIN
from .multiplier_counts import balance
from .parabola import parabola_dips
from .scan import Scan, Spectra

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

    def distance(self, column: int | np.ndarray) -> np.ndarray:
        """One of the distances, or some of the margins', at all points."""
        first = self.first_margin
        return (
            self.distances[:, column]
            if np.max(column, initial=0) < first
            else self.margins[:, column - first] - MARGIN
        )


def evidence(
    engine: Engine,
    rows: np.ndarray,
    smallest: np.ndarray,
    spectra: Spectra,
    slopes: np.ndarray,
    signs: np.ndarray,
    flat: float,
    own: np.ndarray,
) -> Evidence:
    """What points tell.

    Parameters
    ----------
    engine : Engine
    rows : ndarray, shape (n, row_size)
    smallest : ndarray, shape (n,)
        Smallest margins.
    spectra : Spectra
        What their multipliers tell.
    slopes : ndarray, shape (n,)
        The parameter's parts of the tangents; up to ``flat`` they are rounding.
    signs : ndarray, shape (n,)
        Of the bordered determinants.
    flat : float
    own : ndarray, shape (n, o)
        Values of users' tests.
    """
    directions = np.where(np.abs(slopes) > flat, np.sign(slopes), 0.0)
    slopes = np.where(directions != 0.0, slopes, np.nan)
    tests = [*own.T, balance(engine, rows)] if engine.exchanges else own.T
    sides = [
        directions,
        np.sign(signs),
        *(spectra.past + 1),
        *(np.where(values >= 0.0, 1, -1) for values in tests),
    ]
    distances = np.column_stack([slopes, own, smallest - MARGIN])
    return Evidence(np.column_stack(sides).astype(int), distances, rows[:, 2 * engine.m :])


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
    first, lengths = seen.first_margin, scan.lengths
    if len(lengths) < 2:
        return np.arange(first), np.zeros((len(lengths), first), dtype=bool)
    size = np.abs(seen.distances)
    with np.errstate(all="ignore"):
        # as of `scan.low`, of all points at once
        uneven = lengths[1:] / lengths[:-1]
        part = 0.5 * float(np.fmax.reduce(np.fmax(uneven, 1.0 / uneven), initial=1.0)) ** 2
        least = np.fmin.reduce(size, axis=0)
        low = np.flatnonzero(least < part * np.fmax.reduce(np.abs(np.diff(seen.distances, axis=0)), axis=0))
    low_margins = first + np.flatnonzero(scan.low)
    found = np.zeros((len(lengths), first + len(low_margins)), dtype=bool)
    for columns, places in ((low, low), (low_margins, slice(first, None))):
        if not len(columns):
            continue
        values = seen.distance(columns)
        three = np.array([values[:-2], values[1:-1], values[2:]]) * np.sign(values[1:-1])
        dip = parabola_dips(three[0], three[1], three[2], lengths[:-1, None], lengths[1:, None])
        found[:-1, places] |= dip
        found[1:, places] |= dip
    return np.append(np.arange(first), low_margins), found


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
    """Segments of a virtual branch that may be real inside though both ends are not, shape (n - 1,).

    A margin that is negative at both ends may be positive in between where the lines through the two points before and through
    the two behind are, which lie above it wherever it bends downwards, or is a roof, as the reserve of friction is.
    """
    outside = seen.outside
    found = outside[:-1] & outside[1:]
    margins = seen.margins - MARGIN
    kept = (margins[:-1] < 0.0) & (margins[1:] < 0.0)
    for j in np.flatnonzero(kept[found].any(axis=0)):
        found &= _may_rise(margins[:, j], lengths) | ~kept[:, j]
    return found


def _may_rise(margin: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Segments in which both lines of a margin that is negative at both ends are positive at once; of a single segment nothing is known."""
    if len(lengths) < 2:
        return np.zeros(len(lengths), dtype=bool)
    with np.errstate(all="ignore"):
        slopes = np.diff(margin) / lengths
        rises = np.where(slopes[:-1] > 0.0, -margin[1:-1] / slopes[:-1], np.inf)
        falls = np.where(slopes[1:] < 0.0, lengths[:-1] - margin[1:-1] / slopes[1:], -np.inf)
    begins, ends = np.append(0.0, rises), np.append(falls, lengths[-1])
    return (begins < ends) & (begins < lengths) & (ends > 0.0)
