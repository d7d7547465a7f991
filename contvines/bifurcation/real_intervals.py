"""Windows: stretches of a virtual branch, within one step, in which all margins are positive, so that it is real there.

The margins that are negative where a step begins may be positive again before others become negative: none of its ends tells, but
which margins are negative at which end does. A margin may also be negative at both ends and rise above zero in between.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..continuation.chunk import Chunk
from ..continuation.engine import Engine, Solved
from ..continuation.loop import MARGIN
from .dips import below_zero
from .first_border import first_zero
from .segment import Segment

SHOWN = 1e-6  # margins that are certainly positive: where a doubled branch passes through the border of its root, as one round gets what
# another one loses, equations are singular, and margins are known to half their digits


def windows(engine: Engine, chunk: Chunk) -> NDArray[np.bool_]:
    """Segments of a virtual branch that may be real inside though both ends are not, shape (n - 1,).

    A margin that is negative at both ends may be positive in between where the lines through the two points before and through
    the two behind are, which lie above it wherever it bends downwards, or is a roof, as the reserve of friction is.
    """
    margins = engine.margins(chunk.rows) - MARGIN
    below = margins < 0.0
    outside = np.any(below, axis=1)
    found = outside[:-1] & outside[1:]
    kept = below[:-1] & below[1:]
    steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
    lengths = np.sqrt((steps**2) @ engine.weights)
    for j in np.flatnonzero(kept[found].any(axis=0)):
        found &= _may_rise(margins[:, j], lengths) | ~kept[:, j]
    return found


def _may_rise(margin: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Segments in which the lines through the two points before and the two behind, of a margin negative at both ends, are positive at once.

    At either end of the points there is one such line only; of a single segment nothing is known.
    """
    if len(lengths) < 2:
        return np.zeros(len(lengths), dtype=bool)
    with np.errstate(all="ignore"):
        slopes = np.diff(margin) / lengths
        rises = np.where(slopes[:-1] > 0.0, -margin[1:-1] / slopes[:-1], np.inf)
        falls = np.where(slopes[1:] < 0.0, lengths[:-1] - margin[1:-1] / slopes[1:], -np.inf)
    begins, ends = np.append(0.0, rises), np.append(falls, lengths[-1])
    return (begins < ends) & (begins < lengths) & (ends > 0.0)


def passed(segment: Segment) -> tuple[float, Solved] | None:
    """A point of a virtual segment at which all margins are positive, between where the first ones come back and others are lost."""
    engine = segment.engine
    below = [engine.margins(end.row) < MARGIN for end in (segment.a, segment.b)]
    if not (below[0].any() and below[1].any()) or (below[0] & below[1]).any():
        return None
    begins, ends = (first_zero(segment, np.flatnonzero(which), False) for which in below)
    if begins is None or ends is None or not begins.position < ends.position:
        return None
    middle = 0.5 * (begins.position + ends.position)
    point = segment.at(middle)
    if point is None or float(engine.smallest_margin(point.row)) < SHOWN:
        return None
    return middle, point


def real_inside(segment: Segment) -> tuple[float, Solved] | None:
    """A point of a virtual segment at which all margins are positive, or None; see :func:`windows` for which segments may have one."""
    engine = segment.engine
    return passed(segment) or below_zero(
        segment, lambda point: SHOWN - float(engine.smallest_margin(point.row))
    )
