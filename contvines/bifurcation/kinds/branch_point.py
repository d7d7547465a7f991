"""Branch point: another branch crosses, where the bordered matrix [[F_u, F_p], [tangent]] is singular.

A simple one is a change of the sign of its determinant, located on the regular function 1 / (c . M^-1 b) of
:class:`~contvines.bifurcation.determinant.DeterminantTest`. Where multipliers are known each one that passes +1 is a test
function of its own, so that an even number of branches at once is seen, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...continuation.engine import Engine, Solved
from ...continuation.layout import aim_at_multiplier
from ..consistency import unresolved
from ..determinant import alone, by_elimination, by_sign, passes, passes_for_certain, singular, turned
from ..kind import Kind
from ..locate import Root, locate, locate_singular
from ..located import Located, Role
from ..location_error import blurred
from ..multiplier_counts import balance, counts, sizes_by_sort
from ..segment import Segment
from .multipliers import passing


def find(segment: Segment, found: Sequence[Located]) -> list[Located]:
    """The branch points of a segment whose folds and meetings are known."""
    engine = segment.engine
    folds = [e.position for e in found if e.kind == "fold"]
    met = [e.position for e in found if e.role is Role.MEETING]
    points = _sharpened(segment, _by_multipliers(segment, folds, met))
    if not points and engine.exchanges and (double := _exchange(segment)) is not None:
        points.append(double)
    counted = sum(e.kind == "branch-point" for e in points)
    if segment.a.sign * segment.b.sign < 0.0 and (counted + len(met)) % 2 == 0:
        root = by_sign(segment)
        if root is not None and not _near(segment, root.position, met):
            turning = _near(segment, root.position, folds)
            # a side branch may turn where it meets the other one; at a plain fold the sign is that of rounding
            if not turning or (root.point.residual <= engine.settings.exact and singular(engine, root.point)):
                place = Located.at(root, "branch-point", astray=_astray(segment, root))
                if not (place.astray or _may_pass(segment, root)):
                    place = replace(unresolved(segment, root.point), kind="branch-point")
                points.append(place)
    return points


def _may_pass(segment: Segment, root: Root) -> bool:
    """Whether a multiplier may be +1 at a change of the sign; where all are next to zero the sign is that of rounding."""
    engine = segment.engine
    if engine.detection != "map" or engine.scaled:
        return True
    rows = (segment.a.row, root.point.row, segment.b.row)
    return any(np.abs(engine.spectrum(row)).max(initial=0.0) > 0.5 for row in rows)


def _by_multipliers(segment: Segment, folds: list[float], met: list[float]) -> list[Located]:
    """Where multipliers pass +1 beside folds and meetings."""
    engine = segment.engine
    tests = passing(segment, "plus")
    # machines have exact counts; a count of eigenvalues that are next to nothing beside others may be that of rounding
    rounded = engine.scaled and engine.signed and len(tests) % 2 != turned(segment.a, segment.b)
    if len(tests) == 1 and engine.scaled:
        # a fold changes the sign of det(F_u) alone, a branch point that of the bordered matrix, too
        one_fold = len(folds) == 1 and segment.a.sign * segment.b.sign > 0.0
        if one_fold or (rounded and not passes(segment, 0.5, 0.5 + engine.settings.aside)):
            return []
    points = []
    for test in tests:
        root = locate(segment, test.function, jump=test.jump)
        if root is None or not root.continuous or _near(segment, root.position, folds + met):
            continue
        unit = min(1.0, *(float(np.abs(engine.spectrum(end.row)).max()) for end in (segment.a, segment.b)))
        if abs(test.function(root.point)) > engine.settings.critical * unit or _complex(segment, root.point):
            continue  # two real multipliers met and left the axis; none of them was at the boundary
        if not passes_for_certain(segment, root.position):
            continue
        if alone(engine, root.point):
            # neighbouring branches have opposite signs; on one branch the parameter turns by no more than rounding
            if segment.a.sign * segment.b.sign < 0.0:
                points.append(Located.at(root, "", astray=True))
        elif not rounded or passes(segment, root.position):
            points.append(Located.at(root, "branch-point", test.index))
    return points


def _complex(segment: Segment, point: Solved) -> bool:
    """Whether it was a pair that passed the axis, where only branch points are looked for."""
    engine = segment.engine
    if engine.detection != "real":
        return False
    near, ends = (engine.spectrum(row) for row in (point.row, np.array([segment.a.row, segment.b.row])))
    one = near[np.argmin(np.abs(near.real))]  # the one that passes; another may be next to nothing all along
    unit = min(1.0, float(np.abs(ends).max())) if one.imag else 1.0
    return bool(abs(one) > engine.settings.critical * unit)


def _sharpened(segment: Segment, points: list[Located]) -> list[Located]:
    """Branch points again, through interpolation; those at one and the same place from the mean of their tests."""
    engine = segment.engine
    result = [e for e in points if e.kind != "branch-point"]
    points = [e for e in points if e.kind == "branch-point"]
    aims = {test.index: test.function for test in passing(segment, "plus")}
    while points:
        group = [e for e in points if abs(e.position - points[0].position) <= engine.settings.close]
        points = [e for e in points if e not in group]
        gaps = [0.4 * abs(e.position - group[0].position) for e in points]
        mean = partial(_mean, [aims[e.index] for e in group])
        root = locate_singular(segment, mean, group[0].position, width=min([0.2, *gaps]))
        if engine.detection == "real" and len(group) == 1:
            root = by_elimination(segment, root)
        for event in group:
            found = event if root is None else Located.at(root, event.kind, event.index)
            result.append(blurred(segment, found, aims[event.index]))
    return result


def _mean(tests: list, point: Solved) -> float:
    return sum(test(point) for test in tests) / len(tests)


def _exchange(segment: Segment) -> Located | None:
    """A branch point where one multiplier leaves the circle while another enters; see :func:`balance`."""
    engine = segment.engine

    def test(point: Solved) -> float:
        return float(balance(engine, point.row))

    if not test(segment.a) * test(segment.b) < 0.0:
        return None
    rough = locate(segment, test, tolerance=engine.settings.close)
    if rough is None:
        return None
    aim = aim_at_multiplier(
        engine.m, engine.detection, "plus", max(int(counts(engine, rough.point.row)[0]), 1)
    )
    if abs(test(rough.point)) > engine.settings.critical or (
        engine.detection != "real" and abs(aim(rough.point)) > engine.settings.critical
    ):
        return None
    if _complex(segment, rough.point) or not passes_for_certain(segment, rough.position):
        return None
    root = locate_singular(segment, test, rough.position) or rough
    ends = max(_nearest(engine, segment.a.row), _nearest(engine, segment.b.row))
    # both may be next to nothing, one on either side, without being zero
    return (
        Located.at(root, "branch-point")
        if _nearest(engine, root.point.row) <= engine.settings.aside * ends
        else None
    )


def _nearest(engine: Engine, row: np.ndarray) -> float:
    """How far from the circle the nearest real multiplier is."""
    return float(np.nanmin(np.abs(sizes_by_sort(engine, row)[0]), initial=np.inf))


def _astray(segment: Segment, root: Root) -> bool:
    """Whether the segment has led from one branch to another, so that there is no branch point."""
    engine = segment.engine
    return not (engine.many or segment.length <= engine.settings.resolution or singular(engine, root.point))


def _near(segment: Segment, position: float, others: list[float]) -> bool:
    return any(abs(position - other) <= segment.engine.settings.near for other in others)


KIND = Kind(
    "branch-point",
    "BP",
    text="branch point",
    marker="o",
    filled=False,
    find=find,
    locus="branch",
    leaves="branch",
    without="another branch crosses here; this problem has no equations for it",
)
