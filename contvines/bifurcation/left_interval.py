"""Excursions: a branch that leaves the interval between two points that lie in it, turns back outside, and comes in again."""

from __future__ import annotations

from .locate import locate
from .located import Located, Role
from .segment import Segment

ROUNDING = 1e-13  # of the parameter, in its unit: what turns back there does so at the end of the interval


def left_between(segment: Segment, events: list[Located]) -> Located | None:
    """Where a branch leaves the interval within a segment: before the first of its events that lies outside; None if none does."""
    engine = segment.engine
    for event in events:
        bound = min(max(event.point.p, engine.lower), engine.upper)
        if abs(event.point.p - bound) <= max(event.error, ROUNDING * engine.parameter_unit(bound)):
            continue
        root = locate(Segment(engine, segment.a, event.point), lambda point, bound=bound: point.p - bound)
        if root is None:
            continue
        found = engine.at_value(root.point.u, bound, root.point.tangent) or root.point
        position = event.position * root.position
        return Located(position, "", 0, found, (segment.a.p, event.point.p), 0.0, Role.LEFT)
    return None
