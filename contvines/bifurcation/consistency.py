"""Consistency: what both ends of a segment say must agree with the special points found between them.

Along one branch

* the parameter's direction changes at folds,
* the sign of det [[F_u, F_p], [tangent]] changes at branch points of odd multiplicity and where the branch meets its own image,
* the number of multipliers outside the circle (right of the axis) changes by one at folds, branch points and flips, by two at pairs.

Neighbouring branches have opposite signs of the determinant, so a step from one branch to another shows, too: it is traced again with
shorter ones (:mod:`contvines.branches.tracing`). Any other segment that does not agree is halved until its parts do, or are as short as
`Settings.resolution`; then the graph says that it is unresolved.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..continuation.engine import Solved
from .determinant import turned
from .located import Located, Role
from .multiplier_counts import pairs_past
from .segment import Segment

#: sort of multipliers -> kinds at which one of them passes the circle
PASSED_AT = (
    ("fold", "branch-point"),
    ("period-doubling", "symmetry-breaking"),
    ("neimark-sacker", "hopf"),
)


def unaccounted(segment: Segment, found: Sequence[Located]) -> bool:
    """Whether the numbers of multipliers past the circle change by more than the points found between say.

    Real multipliers may go through infinity, or come from one side of the axis to the other as pairs: of an odd number one has passed the
    circle, and so has one where the number outside changes.
    """
    engine = segment.engine
    before, after = segment.counts
    if engine.detection == "map" and not engine.adaptive and _hidden_beside_fold(segment, found):
        return True
    plus, minus, pairs = (b - a for a, b in zip(before, after))
    if engine.detection == "real" and plus and plus % 2 == 0:
        ends = pairs_past(engine, np.array([segment.a.row, segment.b.row]))
        plus -= int(ends[1] - ends[0])  # a pair has passed the axis, where only branch points are looked for
    side = turned(segment.a, segment.b)
    if engine.scaled and engine.signed and abs(plus) == 1 and side is False:
        plus = 0  # a count that the determinant contradicts is that of rounding
    if max(abs(end.tangent[-1]) for end in (segment.a, segment.b)) <= engine.upright(segment.a.p):
        plus = 0  # det(F_u) vanishes with the parameter's part of the tangent, all along an upright branch
    if not engine.scaled and engine.detection == "map" and side is not None and plus % 2 != side:
        # det(F_u) keeps its sign where one comes back from infinity, as where an event of a virtual orbit grazes
        short = segment.length <= 2.0 * engine.settings.resolution
        return not (minus == -plus and pairs == 0 and (short or segment.through_infinity()))
    known = [sum(e.kind in kinds for e in found) for kinds in PASSED_AT]
    known[0] += sum(e.astray for e in found)
    missing = any(abs(change) > number for change, number in zip((plus, minus, pairs), known))
    return missing and (plus + minus + 2 * pairs != 0 or plus % 2 == 1)


def _hidden_beside_fold(segment: Segment, found: Sequence[Located]) -> bool:
    """Whether the multipliers outside the circle at a fold, its own left out, are others than at the ends, though nothing else was found.

    A pair may leave the circle next to a fold, part on the real axis and come back there by one: the ends differ by that one alone.
    """
    if len(found) != 1 or found[0].kind != "fold":
        return False
    spectrum, near = segment.engine.spectrum(found[0].point.row), segment.engine.settings.critical
    others = np.abs(np.delete(spectrum, np.argmin(np.abs(spectrum - 1.0))))
    if np.any(np.abs(others - 1.0) <= near):
        return False
    outside = int(np.count_nonzero(others > 1.0))
    totals = [plus + minus + 2 * pairs for plus, minus, pairs in segment.counts]
    return any(total not in (outside, outside + 1) for total in totals)


def unresolved(segment: Segment, middle: Solved) -> Located:
    """A mark in the middle of a segment that is not halved any more, though its ends say more than what is found on it."""
    ends = (segment.a.p, segment.b.p)
    return Located(0.5, "", 0, middle, ends, 0.5 * abs(ends[1] - ends[0]), Role.UNRESOLVED)
