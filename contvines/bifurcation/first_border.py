"""Borders: where on a segment a branch ceases to be real (or becomes so again), and which margin says so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, MARGINS, Aim
from ..shared.floating_point import EPSILON
from .kinds import BORDERS
from .locate import Root, locate
from .segment import Segment

MARGIN_ROUNDING = 2.0 * EPSILON  # of margins, in units of the machine's own size
BENT = 0.1  # part of the distance of the point close before a border at which its margin tells a bend
NEARER = 0.05, 0.03, 0.02, 0.01, 0.005  # parts of it at which unknowns that are known to few digits show
TOLD = 10.0  # times that: a difference of margins which is no rounding
SEEN = 10.0  # times an error that is seen in a few samples: what is stated
ORDER = {name: i for i, name in enumerate(BORDERS)}  # of borders that are met at once


@dataclass(frozen=True, eq=False)
class Border:
    """A border of a segment: where it is, and the margin that vanishes there."""

    root: Root
    index: int


def find_border(segment: Segment, real: bool) -> Border | None:
    """The border of a segment, or None.

    Parameters
    ----------
    segment : Segment
    real : bool
        Whether its beginning has positive margins: the border is where the first one vanishes; else where all are positive again.
    """
    engine = segment.engine
    a, b = (end.row[2 * engine.m :] < MARGIN for end in (segment.a, segment.b))  # not of what is no number
    if real:
        falling = (b & ~a).nonzero()[0]
    else:
        falling = np.arange(len(a) if a.any() and not b.any() else 0)
    if not len(falling):
        return None
    root = first_zero(segment, falling, real)
    if root is None:
        return None
    if len(falling) == 1:
        return Border(root, int(falling[0]))
    if not real:
        # another margin that is zero to rounding all along hides where those that were negative come back
        own = first_zero(segment, a.nonzero()[0], real)
        if own is not None and engine.smallest_margin(own.point.row) >= MARGIN:
            root = own
    if real:
        passing = _passing(segment, root, falling)
        if len(passing) < len(falling):
            again = first_zero(segment, passing, real)
            if again is not None and engine.margins(again.point.row)[falling].min() >= MARGIN:
                root, falling = again, passing
    return Border(root, _which(engine, engine.margins(root.point.row), falling))


def first_zero(segment: Segment, chosen: NDArray[np.intp], real: bool) -> Root | None:
    """Where the smallest of the chosen margins passes zero."""
    margin = Aim(MARGINS, 2 * segment.engine.m + chosen)
    root = locate(segment, margin, fallback_zero=real)
    if root is None or root.position > 0.0 or not margin(root.point) < 0.0:
        return root
    # the segment begins behind the border, by what counts as rounding: where the margin is flat that may be seen in the parameter
    settings = segment.engine.settings
    ahead = segment.at(min(1.0, max(settings.aside, settings.close / segment.length)))
    fall = 0.0 if ahead is None else margin(root.point) - margin(ahead)
    if ahead is None or not fall > 0.0:
        return root
    return root._replace(error=abs(margin(root.point) / fall * (ahead.p - root.point.p)))


def _passing(segment: Segment, root: Root, falling: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of the margins that are negative just behind a border.

    Of a cycle that repeats itself at the border, as where a stick vanishes in every other round, the margins of the other
    rounds touch zero there, and come back; that they are negative at the end of the segment is another matter.
    """
    here = segment.engine.margins(root.point.row)[falling]
    settings = segment.engine.settings
    for step in (settings.aside, 10.0 * settings.aside):
        point = segment.at(root.position + step)
        if point is not None:
            there = segment.engine.margins(point.row)[falling]
            passing = falling[(there < MARGIN) & (here <= here.min() + np.sqrt(settings.tied))]
            if len(passing):
                return passing
    return falling


def rounding(segment: Segment, root: Root, index: int, before: Solved | None) -> float:
    """How far rounding of the margins that vanish at a border, and of its unknowns, may move its parameter value.

    Where a margin is flat it is zero, but for rounding, far from the last bracket; of one that is that all along nobody knows where it
    passes zero. The point close before the border may be known.
    """
    first, place, point = 2 * segment.engine.m, root.position, root.point
    margins = point.row[first:]
    sloped = segment.engine.settings.close  # from here on the slope of a margin can be told
    flat = np.abs(margins) < TOLD * MARGIN_ROUNDING
    flat[index] = True
    flat = flat.nonzero()[0]
    here, error = _finite(margins[flat]), 0.0
    towards = -1.0 if place * segment.length > sloped else 1.0
    room = place if towards < 0.0 else 1.0 - place
    reach = min(sloped / segment.length, room)
    aside = before if towards < 0.0 else segment.at(place + reach)
    if aside is not None and reach < room:
        error = _scatter(segment, root, index, towards * reach, aside)
    while reach > 0.0 and (aside := aside or segment.at(place + towards * reach)) is not None:
        rises, moved = np.abs(_finite(aside.row[first:][flat]) - here), abs(aside.p - point.p)
        told = rises > TOLD * MARGIN_ROUNDING
        if told.any():
            error = max(error, moved * MARGIN_ROUNDING / float(rises[told].min()))
            flat, here = flat[~told], here[~told]
        if not len(flat):
            break
        if reach == room:
            error = max(error, moved)
            break
        reach, aside = min(30.0 * reach, room), None
    return error


def _scatter(segment: Segment, root: Root, index: int, reach: float, aside: Solved) -> float:
    """How far unknowns that are not known to the last digits, as where two events fall together, may move the parameter value of a border.

    They show in the margin, close before the border, as its distance from the parabola through the border and two points farther away: a
    smooth margin lies on it. Of a margin that jumps at the border nothing is said.
    """
    j = 2 * segment.engine.m + index
    points = segment.several([root.position + part * reach for part in (BENT, *NEARER)])
    found = [float(point.row[j] - root.point.row[j]) for point in (aside, *points) if point is not None]
    rises, nearer = np.array(found), np.array(NEARER)
    if len(rises) < 2 + len(nearer) or not np.isfinite(rises).all():
        return 0.0
    if not (np.abs(rises[2:]) < 0.5 * abs(rises[0])).all():
        return 0.0
    bend = (rises[1] / BENT - rises[0]) / (BENT - 1.0)
    apart = float(np.abs(rises[2:] - nearer * (rises[0] + (nearer - 1.0) * bend)).max())
    return SEEN * apart / abs(rises[0]) * abs(aside.p - root.point.p)


def _finite(margins: np.ndarray) -> np.ndarray:
    """Margins, those that do not apply or have no bound as large ones."""
    return np.where(np.isfinite(margins), margins, 1.0)


def _which(engine: Engine, margins: np.ndarray, falling: NDArray[np.intp]) -> int:
    """The margin that vanishes. Several may, as when a stick disappears: which one is smallest is then a matter of

    rounding, so those that are as small as the smallest one count as equal, and the order of kinds decides.
    """
    tied = falling[margins[falling] <= margins[falling].min() + engine.settings.tied]
    kinds = [engine.problem.margin_kind(int(j)) for j in tied]
    return int(tied[min(range(len(tied)), key=lambda i: (ORDER.get(kinds[i], len(ORDER)), i))])
