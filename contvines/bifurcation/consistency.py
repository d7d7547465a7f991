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

from .determinant_test import turned
from .located import Located
from .segment import Segment

#: sort of multipliers -> kinds at which one of them passes the circle
PASSED_AT = (
    ("fold", "branch-point", "astray"),
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
    plus, minus, pairs = (b - a for a, b in zip(before, after))
    side = turned(segment.a, segment.b)
    if engine.scaled and engine.signed and abs(plus) == 1 and side is False:
        plus = 0  # a count that the determinant contradicts is that of rounding
    if not engine.scaled and engine.detection == "map" and side is not None and plus % 2 != side:
        # det(F_u) keeps its sign where one comes back from infinity, as where an event of a virtual orbit grazes
        return True
    missing = any(
        abs(change) > sum(e.kind in kinds for e in found)
        for change, kinds in zip((plus, minus, pairs), PASSED_AT)
    )
    return missing and (plus + minus + 2 * pairs != 0 or plus % 2 == 1)
