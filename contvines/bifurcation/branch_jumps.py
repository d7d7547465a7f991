"""Leaps: a step that ends on another branch, where two branches nearly touch.

Along one branch the sign of det [[F_u, F_p], [tangent]] changes at branch points only, and neighbouring branches have
opposite signs. Steps longer than the gap between two branches pass the rule of the loop, which compares tangents: beside
the gap they agree. So a changed sign that no branch point accounts for is a leap, and so is a special point that cannot
be located, because the test function jumps with the branch.

The branch is then traced again from the point before the gap, with shorter steps: see :mod:`contvines.branches.tracing`.
"""

from __future__ import annotations

from .consistency import unresolved
from .determinant import certain
from .located import Located, Role
from .location_error import singular_within
from .segment import Segment

NOISY = 2e3  # times the noise of the equations: places are no better than this


def leap(segment: Segment, found: list[Located]) -> Located | None:
    """A mark at the start of the segment if its ends lie on different branches; unresolved if it is too short to tell.

    Parameters
    ----------
    segment : Segment
    found : list of Located
        What was found on it, in order; positions in [0, 1].
    """
    stop = next((i for i, e in enumerate(found) if e.ends_branch), len(found))
    short = segment.length <= segment.engine.settings.resolution
    changed = _unaccounted(segment, found, stop)
    if not changed and (short or not any(inexact(segment, e) for e in found[: stop + 1])):
        return None
    ends = (segment.a.p, segment.b.p)
    if short:
        middle = segment.at(0.5)
        return None if middle is None else unresolved(segment, middle)
    return Located(0.0, "", 0, segment.a, ends, 0.0, Role.LEAP)


def inexact(segment: Segment, event: Located) -> bool:
    """Whether a special point could not be located as well as those are that exist."""
    if event.role is Role.UNRESOLVED:
        return False
    unit = segment.engine.parameter_unit(event.point.p)
    noise, scaled = segment.engine.noise, segment.engine.problem.scales is not None
    least = max(segment.engine.settings.located, NOISY * noise)
    solved = segment.engine.settings.exact if scaled and not noise and event.kind == "branch-point" else least
    vague = event.error > 10.0 * least * unit
    if vague and event.kind == "branch-point":
        # no better than the rounding of its matrix allows
        point = event.point
        vague = event.error > singular_within(segment.engine, point.u, point.p, point.tangent)
    if event.astray or vague:
        return True
    residual = event.point.residual  # sizes are one at least
    return residual > solved and residual > solved * segment.engine.size(event.point.u)


def _unaccounted(segment: Segment, found: list[Located], stop: int) -> bool:
    """Whether the sign changes before the branch ends, and nothing was found at which it may."""
    if any(e.kind == "branch-point" or e.role is Role.MEETING for e in found[: stop + 1]):
        return False
    last = segment.b if stop == len(found) else found[stop].point
    if not segment.a.sign * last.sign < 0.0:
        return False
    # an end may itself be singular (a stick of length zero): its sign is that of roundoff
    reach = 1.0 if stop == len(found) else found[stop].position
    aside = segment.engine.settings.aside
    beside = segment.several([share * reach for share in (aside, 1.0 - aside)])
    if beside[0] is not None and beside[1] is not None and not beside[0].sign * beside[1].sign < 0.0:
        return False
    return certain(segment.engine, segment.a) and certain(segment.engine, last)
