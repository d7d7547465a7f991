"""Branch points: another branch crosses, and the bordered matrix M = [[F_u, F_p], [tangent]] is singular.

At a simple branch point its determinant changes sign; the point is located as a zero of the smooth function 1 / (c . M^-1 b) of
:class:`DeterminantTest`. If multipliers are known, each one that crosses +1 is a test function of its own, so that an even number of
branches that cross at once is detected, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import NO_COLUMNS, SIGN, Aim, aim_at_multiplier
from ..shared.numbers import TINY
from .consistency import is_jump, no_other_branch, sign_changes, singular, surely_changes, turned, unresolved
from .kind import Kind, passing
from .locate import Located, Role, Root, Segment, locate, locate_singular
from .location_error import with_rounding_error
from .scan import balance, counts, sizes_by_sort

WIDTH = 0.02  # half width of the window, relative to the segment, in which the determinant refines a known position
AT_SIGNS = Aim(SIGN, NO_COLUMNS)


class DeterminantTest:
    """A smooth function with a simple zero where [[F_u, F_p], [border]] is singular: 1 / (c . M^-1 b).

    b is a fixed vector; c is the direction of M^-1 b, computed at the first point that is evaluated, which must be near the zero.
    """

    def __init__(self, engine: Engine, border: np.ndarray) -> None:
        self.engine, self.border = engine, border
        self.side = np.random.default_rng(2).standard_normal(engine.n + 1)
        self.side[-1] = 0.0
        self.row: np.ndarray | None = None

    def __call__(self, point: Solved) -> float:
        engine = self.engine
        engine.residual(point.u, point.p)
        x = engine.apply_inverse(self.border, self.side)
        if self.row is None:
            x2 = engine.apply_inverse(self.border, np.append(x[:-1], 0.0))
            self.row = x2 / max(float(np.abs(x2).max()), TINY)
        value = float(self.row @ x)
        return 1.0 / value if value != 0.0 else np.nan


def find(segment: Segment, found: Sequence[Located]) -> list[Located]:
    """Find the branch points of a segment.

    Parameters
    ----------
    segment : Segment
    found : sequence of Located
        Special points found already; folds and meetings must be among them, as multipliers cross +1 there, too.
    """
    engine = segment.engine
    folds = [e.position for e in found if e.kind == "fold"]
    meetings = [e.position for e in found if e.role is Role.MEETING]
    points = _sharpened(segment, _by_multipliers(segment, folds, meetings))
    if not points and engine.exchanges and (double := _exchange(segment)) is not None:
        points.append(double)
    counted = sum(e.kind == "branch-point" for e in points)
    if segment.a.sign * segment.b.sign < 0.0 and (counted + len(meetings)) % 2 == 0:
        root = _by_sign(segment)
        if root is not None and not _is_near(segment, root.position, meetings):
            turning = _is_near(segment, root.position, folds)
            # a branch may turn exactly where it meets another one; at a plain fold the change of sign is rounding
            if not turning or (root.point.residual <= engine.settings.exact and singular(engine, root.point)):
                place = Located.at(root, "branch-point", astray=is_jump(segment, root))
                if not (place.astray or _may_pass(segment, root)):
                    place = replace(unresolved(segment, root.point), kind="branch-point")
                points.append(place)
    return points


def _by_sign(segment: Segment) -> Root | None:
    """Locate the change of sign of the determinant on a segment; None if the change may be rounding."""
    rough = locate(segment, AT_SIGNS, tolerance=segment.engine.settings.aside)
    if rough is None or not surely_changes(segment, rough.position):
        return None
    return locate_singular(segment, DeterminantTest(segment.engine, segment.border), rough.position) or rough


def _may_pass(segment: Segment, root: Root) -> bool:
    """Whether a multiplier may be +1 at a change of the determinant's sign; if all are near zero the sign is rounding."""
    engine = segment.engine
    if engine.detection != "map" or engine.scaled:
        return True
    rows = (segment.a.row, root.point.row, segment.b.row)
    return any(np.abs(engine.spectrum(row)).max(initial=0.0) > 0.5 for row in rows)


def _by_multipliers(segment: Segment, folds: list[float], meetings: list[float]) -> list[Located]:
    """Locate multipliers that cross +1 elsewhere than at the given folds and meetings."""
    engine = segment.engine
    tests = passing(segment, "plus")
    # counts of machines are exact; counts of scaled problems may be wrong by rounding, if eigenvalues are tiny beside others
    rounded = engine.scaled and engine.signed and len(tests) % 2 != turned(segment.a, segment.b)
    if len(tests) == 1 and engine.scaled:
        # a fold changes the sign of det(F_u) only, a branch point also that of the bordered determinant
        one_fold = len(folds) == 1 and segment.a.sign * segment.b.sign > 0.0
        if one_fold or (rounded and not sign_changes(segment, 0.5, 0.5 + engine.settings.aside)):
            return []
    points = []
    for test in tests:
        root = locate(segment, test.function, jump=test.jump)
        if root is None or not root.continuous or _is_near(segment, root.position, folds + meetings):
            continue
        unit = min(1.0, *(float(np.abs(engine.spectrum(end.row)).max()) for end in (segment.a, segment.b)))
        if abs(test.function(root.point)) > engine.settings.critical * unit or _complex(segment, root.point):
            continue  # two real multipliers met and became a pair; none of them was on the circle
        if not surely_changes(segment, root.position):
            continue
        if no_other_branch(engine, root.point):
            # opposite signs: the ends lie on neighbouring branches; equal signs: the parameter turns by no more than rounding
            if segment.a.sign * segment.b.sign < 0.0:
                points.append(Located.at(root, "", astray=True))
        elif not rounded or sign_changes(segment, root.position):
            points.append(Located.at(root, "branch-point", test.index))
    return points


def _complex(segment: Segment, point: Solved) -> bool:
    """Whether a complex pair, not a real eigenvalue, crosses the axis at a point, for problems with only branch points ("real")."""
    engine = segment.engine
    if engine.detection != "real":
        return False
    near, ends = (engine.spectrum(row) for row in (point.row, np.array([segment.a.row, segment.b.row])))
    one = near[np.argmin(np.abs(near.real))]  # the critical one; another may be nearly zero all along
    unit = min(1.0, float(np.abs(ends).max())) if one.imag else 1.0
    return bool(abs(one) > engine.settings.critical * unit)


def _sharpened(segment: Segment, points: list[Located]) -> list[Located]:
    """Locate branch points again by interpolation; several at the same position by the mean of their tests.

    The rounding of eigenvalues is relative to the largest of them, which may be 1e9 times the critical ones if the unknowns at the start were far
    larger than here. The determinant may then give the position more accurately.
    """
    engine, settings = segment.engine, segment.engine.settings
    result = [e for e in points if e.kind != "branch-point"]
    points = [e for e in points if e.kind == "branch-point"]
    aims = {test.index: test.function for test in passing(segment, "plus")}
    while points:
        group = [e for e in points if abs(e.position - points[0].position) <= settings.close]
        points = [e for e in points if e not in group]
        gaps = [0.4 * abs(e.position - group[0].position) for e in points]
        tests = [aims[e.index] for e in group]

        def mean(point: Solved, tests: list = tests) -> float:
            return sum(test(point) for test in tests) / len(tests)

        root = locate_singular(segment, mean, group[0].position, width=min([0.2, *gaps]))
        unit = 0.0 if root is None else engine.parameter_unit(root.point.p)
        vague = root is not None and root.error > settings.rounding * unit
        if root is not None and vague and engine.detection == "real" and len(group) == 1:
            other = locate_singular(segment, DeterminantTest(engine, segment.border), root.position, WIDTH)
            if other and other.error < root.error and abs(other.position - root.position) < WIDTH:
                root = other
        for event in group:
            found = event if root is None else Located.at(root, event.kind, event.index)
            result.append(with_rounding_error(segment, found, aims[event.index]))
    return result


def _exchange(segment: Segment) -> Located | None:
    """Locate a branch point at which one multiplier leaves the circle while another enters; see :func:`contvines.bifurcation.scan.balance`."""
    engine = segment.engine

    def test(point: Solved) -> float:
        return float(balance(engine, point.row))

    def nearest(point: Solved) -> float:
        """Return the distance of the nearest real multiplier from the circle."""
        return float(np.nanmin(np.abs(sizes_by_sort(engine, point.row)[0]), initial=np.inf))

    if not test(segment.a) * test(segment.b) < 0.0:
        return None
    rough = locate(segment, test, tolerance=engine.settings.close)
    if rough is None:
        return None
    rank = max(int(counts(engine, rough.point.row)[0]), 1)
    aim = aim_at_multiplier(engine.m, engine.detection, "plus", rank)
    numbers = [test(rough.point)] + ([] if engine.detection == "real" else [aim(rough.point)])
    if max(map(abs, numbers)) > engine.settings.critical or _complex(segment, rough.point):
        return None
    if not surely_changes(segment, rough.position):
        return None
    root = locate_singular(segment, test, rough.position) or rough
    # both may be nearly zero, one on either side, without being zero
    on_circle = nearest(root.point) <= engine.settings.aside * max(nearest(segment.a), nearest(segment.b))
    return Located.at(root, "branch-point") if on_circle else None


def _is_near(segment: Segment, position: float, others: list[float]) -> bool:
    """Whether a position is equal to one of the others within `Settings.near`."""
    return any(abs(position - other) <= segment.engine.settings.near for other in others)


BRANCH_POINT = Kind(
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
