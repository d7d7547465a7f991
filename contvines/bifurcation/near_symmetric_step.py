"""Steps that end next to a meeting: so near to the fixed space of a symmetry that tangents and multipliers there are those of rounding.

A doubled branch that comes back to the fixed space is there as singular as any branch point: the nearer a point, the more of the other
branch rounding mixes into its tangent. What such points say, that the parameter turns, that a multiplier passes the circle, or that the
branch goes on where it is its own image, is nothing. A step of another length ends elsewhere, and its successor passes the meeting.
"""

from __future__ import annotations

import numpy as np

from ..continuation.chunk import Chunk
from ..continuation.status import Status
from .located import Located, Role
from .segment_flags import LANDING

OTHER = 0.7  # part of such a step that ends, and whose successor ends, further away


def first_landing(chunk: Chunk, flags: np.ndarray) -> int | None:
    """The first of the flagged segments that ends next to a meeting, and may end elsewhere; None if there is none."""
    movable = flags if chunk.status == Status.RUNNING else flags[:-1]
    (found,) = (movable & LANDING).nonzero()
    return int(found[0]) if len(found) else None


def again(chunk: Chunk, i: int) -> Located:
    """A mark at point i, from which the branch is to be traced again."""
    bracket = (float(chunk.values[i]), float(chunk.values[i + 1]))
    return Located(float(i), "", 0, chunk.solved(i), bracket, 0.0, Role.LANDING)
