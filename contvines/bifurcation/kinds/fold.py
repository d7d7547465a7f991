"""Fold: the parameter turns back along the branch, where its part of the tangent passes zero."""

from __future__ import annotations

from ...continuation.layout import NO_COLUMNS, SLOPE, Aim
from ..consistency import alone
from ..kind import Classified, Kind, Point, PointOnBranch, Test
from ..locate import Segment
from ..location_error import rounding_of_parameter
from ..normal_forms.along_branch import fold_coefficient
from .multipliers import passing

TURN = Aim(SLOPE, NO_COLUMNS)


def tests(segment: Segment) -> list[Test]:
    """The parameter's part of the tangent, if it has another sign at the other end.

    On an upright branch it is rounding. Of cycles on a mesh the multiplier that passes +1 tells there, as at the folds of canards.
    """
    one, other = float(segment.a.tangent[-1]), float(segment.b.tangent[-1])
    if segment.engine.adaptive and _upright(segment):
        passed = passing(segment, "plus")
        return passed if len(passed) == 1 else []
    upright = not segment.turns and max(abs(one), abs(other)) <= segment.engine.upright(segment.a.p)
    return [] if upright or (one >= 0.0) == (other >= 0.0) else [Test(TURN)]


def _upright(segment: Segment) -> bool:
    """Whether the parameter's direction is rounding at an end of a segment."""
    return min(abs(end.tangent[-1]) for end in (segment.a, segment.b)) <= segment.engine.upright(segment.a.p)


def turns_back(point: Point) -> bool:
    """Whether the parameter turns back by more than rounding and the noise of the equations, or stands still where no other branch passes."""
    assert isinstance(point, PointOnBranch) and point.segment is not None
    segment, engine = point.segment, point.engine
    if engine.adaptive and _upright(segment):
        return alone(engine, point.solved)
    if segment.turns:
        return True
    moved = max(abs(segment.a.p - point.value), abs(segment.b.p - point.value))
    blur = rounding_of_parameter(engine, point.solved) if engine.adaptive else 0.0
    return moved > max(engine.settled(point.value), blur)


def classify(point: PointOnBranch) -> Classified:
    """Coefficient a of p = p0 + a s^2, s the amplitude along the critical vector."""
    return Classified(None, fold_coefficient(point.engine, point.solved))


KIND = Kind(
    "fold",
    "LP",
    text="fold",
    marker="s",
    tests=tests,
    verify=turns_back,
    classify=classify,
    locus="fold",
    nothing="the branch turns at a fold; no other branch leaves it",
)
