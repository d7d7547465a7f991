"""Blur: how far rounding of the Jacobian moves the place at which an eigenvalue passes the axis."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..continuation.engine import Solved
from ..problems.abilities import Blurred
from .located import Located
from .segment import Segment


def blurred(segment: Segment, event: Located, test: Callable[[Solved], float]) -> Located:
    """The event with an error that covers the rounding of what its eigenvalue was computed from.

    Parameters
    ----------
    segment : Segment
    event : Located
    test : callable
        The eigenvalue's test function, in units of the raw spectrum.
    """
    engine, a, b = segment.engine, segment.a, segment.b
    if engine.detection != "flow" or not isinstance(engine.problem, Blurred):
        return event
    engine.residual(event.point.u, event.point.p)
    change = abs(test(b) - test(a))
    if not change > 0.0:
        return event
    error = engine.problem.blur(engine.work) * abs(b.p - a.p) / change
    return event._replace(error=max(event.error, error)) if math.isfinite(error) else event
