"""Complex pairs of multipliers that pass the circle and come back between two points, so that no count changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..continuation.chunk import Chunk
from ..continuation.engine import Engine, Solved
from .scan import dips
from .segment import Segment

NEARLY = 0.2  # part of the largest of three distances from the circle up to which their parabola counts as touching it
ROUNDED = 1e-12
CONSERVED = 1e-9  # pairs that stay closer to the circle are on it
WITHIN = 0.5  # distance from the circle of a pair that may have been past it since two real multipliers met
PARTS = 12  # of a segment in which a pair comes about: where real multipliers meet nothing is smooth


def touching(engine: Engine, kind: str, chunk: Chunk) -> np.ndarray:
    """Segments in which the outermost complex pair may pass the circle and come back, whatever the other multipliers do.

    Where the parabola through its distances comes close to zero, as bends are not all alike near a fold.
    """
    distance = outermost(engine.spectrum(chunk.rows), kind)
    found = np.zeros(len(chunk) - 1, dtype=bool)
    past = distance < 0.0
    level = np.isfinite(distance[:-2] + distance[1:-1] + distance[2:])
    level &= (past[:-2] == past[1:-1]) & (past[1:-1] == past[2:])
    size = np.abs(distance)
    level &= (size[1:-1] < size[:-2]) | (size[1:-1] < size[2:])
    if not level.any():
        return found
    steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
    lengths = np.sqrt((steps**2) @ engine.weights)
    for i in np.flatnonzero(level):
        low = NEARLY * size[i : i + 3].max()
        left, middle, right = np.maximum(size[i : i + 3] - low, ROUNDED)
        if low > CONSERVED and dips(left, middle, right, lengths[i], lengths[i + 1]):
            found[i : i + 2] = True
    return found


def born(engine: Engine, kind: str, chunk: Chunk) -> np.ndarray:
    """Segments in which a pair comes about or vanishes, or next to these, where no parabola tells, with a pair near the circle."""
    distance = outermost(engine.spectrum(chunk.rows), kind)
    there = np.isfinite(distance)
    alone = there[:-1] != there[1:]
    beside = alone.copy()
    beside[1:] |= alone[:-1]
    beside[:-1] |= alone[1:]
    past = there & (distance <= 0.0)  # a change of side is seen without
    near = there & (distance < WITHIN)
    return beside & (near[:-1] | near[1:]) & ~past[:-1] & ~past[1:]


def outside(segment: Segment, kind: str) -> tuple[float, Solved] | None:
    """A point inside a segment at which a pair is past the circle, or None."""
    for s in np.arange(1, PARTS) / PARTS:
        point = segment.at(float(s))
        if point is not None and outermost(segment.engine.spectrum(point.row), kind) < 0.0:
            return float(s), point
    return None


def outermost(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """Distance of the outermost complex pair of each row from the circle (the axis), positive inside; infinite without pairs."""
    size = np.abs(spectrum) - 1.0 if kind == "map" else spectrum.real
    return -np.where(spectrum.imag > 0.0, size, -np.inf).max(axis=-1, initial=-np.inf)


def side(engine: Engine, kind: str, point: Solved, other: Solved) -> float:
    """Distance of the outermost pair from the circle; negative where it is on another side than at another point."""
    here, there = outermost(engine.spectrum(np.array([point.row, other.row])), kind)
    return float(min(here, 1.0) * np.sign(there)) if np.isfinite(there) else 1.0
