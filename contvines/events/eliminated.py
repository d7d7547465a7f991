"""Simple branch points once more, from eliminations with pivots where eigenvalues know their places badly."""

from __future__ import annotations

from .determinant import DeterminantTest
from .locate import Root, locate_singular
from .segment import Segment

VAGUE = 1e-10  # error of a place, in units of the parameter, from which it is worth while
WIDTH = 0.02  # part of a segment, either side


def by_elimination(segment: Segment, root: Root | None) -> Root | None:
    """The same root, or the one of 1/(c . M^-1 b) beside it if that is known better.

    Eigenvalues are rounded by the largest of them, which may be 1e9 times those that pass zero where the unknowns of the start are far
    larger than here.
    """
    if root is None or not root.error > VAGUE * segment.engine.parameter_unit(root.point.p):
        return root
    other = locate_singular(segment, DeterminantTest(segment.engine, segment.border), root.position, WIDTH)
    if other is None or not other.error < root.error or not abs(other.position - root.position) < WIDTH:
        return root
    return other
