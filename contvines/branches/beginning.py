"""Where a branch begins at a border beyond which its equations go on: one point, and the limits of its multipliers."""

from __future__ import annotations

from ..bifurcation.locate import Root
from ..bifurcation.one_sided_limits import one_sided
from ..bifurcation.segment import Segment
from ..continuation.engine import Engine, Solved
from .half_branch import HalfBranch, piece_of


def from_border(engine: Engine, half: HalfBranch, first: Solved) -> HalfBranch:
    """The half without what is the border itself.

    Where a stick or flight vanishes p is stationary, or another solution crosses; and where the equations are singular, what they
    tell of the multipliers there is rounding.
    """
    again = [
        i
        for i, e in half.events
        if e.kind in ("fold", "branch-point")
        and engine.norm(engine.join(e.point.u - first.u, e.point.p - first.p)) <= engine.settings.one_place
    ]
    half = half.without(again)
    if len(half) < 2:
        return half
    u, p, tangent = half.at(1)
    ends = Solved(u, p, -tangent, first.row, 0.0, 0.0, 0.0), first._replace(tangent=-first.tangent)
    limits, _ = one_sided(Segment(engine, *ends), Root(1.0, ends[1], 0.0))
    half.pieces[0] = piece_of(engine, first._replace(row=limits.row))
    return half
