"""Simple branch points from eliminations with pivots: where a determinant changes its sign, and where eigenvalues know their places badly."""

from __future__ import annotations

from ..continuation.aims import NO_COLUMNS, SIGN, Aim
from .determinant_sign import passes_for_certain
from .determinant_test import DeterminantTest
from .locate import Root, locate, locate_singular
from .segment import Segment

VAGUE = 1e-12  # error of a place, in units of the parameter, from which it is worth while
WIDTH = 0.02  # part of a segment, either side
AT_SIGNS = Aim(SIGN, NO_COLUMNS)


def by_sign(segment: Segment) -> Root | None:
    """Where the determinant of the bordered matrix changes its sign on a segment; None where the change may be that of rounding."""
    rough = locate(segment, AT_SIGNS, tolerance=1e-3)
    if rough is None or not passes_for_certain(segment, rough.position):
        return None
    return locate_singular(segment, DeterminantTest(segment.engine, segment.border), rough.position) or rough


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
