"""Examining one segment of a branch: which special points it holds, and where."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from ..continuation.aims import NO_COLUMNS, SLOPE, Aim, aim_at_multiplier
from ..continuation.engine import Engine, Solved
from ..problems.abilities import Adaptive
from .blur import blurred
from .borders import find_border, rounding
from .certain import passes_for_certain
from .determinant import passes, turned
from .eliminated import by_elimination, by_sign
from .leaps import SHORTEST
from .limits import CLOSE, one_sided
from .locate import Root, locate, locate_singular
from .located import Located, Role
from .multipliers import balance, counts_at
from .scan import FLAT
from .segment import Segment
from .singular import singular
from .symmetry import SymmetryTest
from .users import user_function

NOWHERE = (math.nan, math.nan)  # the bracket of what nobody has put on its branch yet
NAMES = ("plus", "minus", "pair")
AT_FOLDS = Aim(SLOPE, NO_COLUMNS)
REACHED = 1e-4  # distance from the stability boundary at which a located multiplier counts as being on it
# residual of a branch point where a side branch turns; halfway between two branches it is larger
EXACT = 1e-13
STATIONARY = 1e-6  # slopes of the parameter below this, at a located multiplier +1, may be those of a fold
BESIDE = 1e-3  # part of a segment, either side of such a place, by which they are told
ROUNDING = 1e-12  # of the parameter, where it is the same all along a segment
CLEAR = 1e-4  # distance from a meeting (in the metric) within which tangents and multipliers are those of its singular equations
DEEPEST = 16  # parts of parts of a segment that are looked at
FAR = 3.0  # decades between a multiplier and the circle
SAME = 1e-4  # events of a segment closer than this (in its length) are one and the same


class Examiner:
    """Finds the special points of segments.

    Parameters
    ----------
    engine : Engine
    user_functions : mapping of name to function, optional
        See :func:`contvines.events.users.user_function`.
    stops : collection of str
        Names of those at whose zeros a branch ends.
    """

    def __init__(
        self,
        engine: Engine,
        user_functions: Mapping[str, Any] | None = None,
        stops: Collection[str] = (),
    ) -> None:
        self.engine, self.stops = engine, stops
        problem = engine.problem
        self.kind = engine.detection
        # of problems without scales of their own, machines, branches of this sort are not known
        self.scaled = problem.scales is not None
        self.exchanges = self.scaled and self.kind != "none"
        # of problems with many unknowns the rows tell eigenvalues only where they are asked for
        self.many = bool(getattr(problem, "many", False))  # `Nearing`; to ask the protocol takes longer
        # multipliers of smooth flows jump by rounding alone, as beside homoclinic orbits: parts of parts tell no more
        self.adaptive = isinstance(problem, Adaptive)
        self.deepest = 1 if self.adaptive else DEEPEST
        self.signed = bool(getattr(problem, "signed", True))
        scale = None if engine.plain else engine.scale[:-1]
        self.symmetries = [SymmetryTest(s, engine.n, engine.shift, scale) for s in problem.symmetries]
        self.users = {name: user_function(engine, f) for name, f in (user_functions or {}).items()}

    def examine(self, segment: Segment, real: bool = True, depth: int = 0) -> list[Located]:
        """The special points of one segment (positions in [0, 1])."""
        borders, last = self._borders(segment, real)
        if borders and depth < DEEPEST:
            # behind a border multipliers may come back from infinity, and what they say of both ends together is nothing
            short = borders[0].position - CLOSE / segment.length
            if last is not None or not short > 0.0:
                part = [] if last is None else self.before(segment, short, last, real, depth + 1)
                return part + borders
        events = self._meetings(segment)
        if events:
            # behind a meeting lies the image of what is before it, so that what was passed before it is passed again
            first = min(e.position for e in events)
            short = first - max(BESIDE * first, CLEAR / segment.length)
            if not short > 0.0:
                return events
            last = segment.at(short)
            if last is not None:
                return events + self.before(segment, short, last, real, depth)
        a, b = segment.a, segment.b
        met = [e.position for e in events]
        folds = self._fold(segment, met)
        counted, discarded = 0, False
        crossings: list[Located] = []
        before, after = self._counts(a), self._counts(b)
        if self.adaptive and self._far_from_circle(a, b):
            after = before
        # machines have exact counts; a count of eigenvalues that are next to nothing beside others may be that of rounding
        odd, side = (after[0] - before[0]) % 2, turned(a, b)
        rounded = self.scaled and self.signed and odd != side
        # det(F_u) keeps its sign where one comes back from infinity, as where an event of a virtual orbit grazes: the ends do not tell
        infinite = not self.scaled and self.kind == "map" and side is not None and odd != side
        if abs(after[0] - before[0]) == 1 and self.scaled:
            # a fold changes the sign of det(F_u) alone, a branch point that of the bordered matrix, too
            one_fold = len(folds) == 1 and a.sign * b.sign > 0.0
            if one_fold or (rounded and not passes(segment, 0.5, 0.5 + BESIDE)):
                after = [before[0], *after[1:]]
        for name, one, other in zip(NAMES, before, after):
            for k in range(min(one, other) + 1, max(one, other) + 1):
                test = self._multiplier(name, k)
                root = locate(segment, test, jump=0.05)
                if root is None or not root.continuous:
                    discarded = True
                    continue
                if name != "plus":
                    crossings.append(blurred(segment, self._located(root, self._kind(name), k), test))
                elif abs(test(root.point)) > REACHED or self._complex(segment, root.point):
                    continue  # two real multipliers met and left the axis; none of them was at the boundary
                elif not _near(root.position, [e.position for e in folds] + met):
                    if self._turns_back(segment, root):
                        folds.append(self._located(root, "fold", 0))
                    elif not passes_for_certain(segment, root.position):
                        continue
                    elif self._regular(root.point):
                        folds.append(self._located(root, "astray", 0))
                    elif not rounded or passes(segment, root.position):
                        crossings.append(self._located(root, "branch-point", k))
        for fold in folds:
            crossings += self._around(segment, fold, before, after)
        # real multipliers come from one side of the axis to the other as pairs: of an odd number one has passed the circle
        plus, minus, pairs = (other - one for one, other in zip(before, after))
        passed = plus + minus + 2 * pairs != 0 or plus % 2 == 1
        if (infinite or (discarded and passed)) and depth < self.deepest:
            middle = segment.at(0.5)
            if middle is not None:
                return self.both(segment, 0.5, middle, real, depth + 1)
        events += folds
        for event in self._sharpen(segment, crossings):
            events.append(event)
            counted += event.kind == "branch-point"
        if not counted and (double := self._exchange(segment)) is not None:
            events.append(double)
        if a.sign * b.sign < 0.0 and (counted + len(met)) % 2 == 0:
            root = by_sign(segment)
            if root is not None and not _near(root.position, met):
                turning = [e for e in folds if _near(e.position, [root.position])]
                # a side branch may turn where it meets the other one; at a plain fold the sign is that of rounding
                if not turning or (root.point.residual <= EXACT and singular(self.engine, root.point)):
                    events = [e for e in events if e not in turning]
                    events.append(self._located(root, self._where_singular(segment, root, "branch-point"), 0))
        return events + borders

    def _far_from_circle(self, a: Solved, b: Solved) -> bool:
        """Whether as many multipliers are outside the circle at both ends, and all so far from it that none has passed it: they turn beside a
        homoclinic orbit."""
        sizes = np.abs(self.engine.spectrum(np.array([a.row, b.row])))
        with np.errstate(all="ignore"):
            logs = np.abs(np.log10(sizes))
        counts = (sizes > 1.0).sum(axis=1)
        return bool((logs > FAR).all() and counts[0] == counts[1])

    def _exchange(self, segment: Segment) -> Located | None:
        """A branch point where one multiplier leaves the circle while another enters; see :func:`balance`."""
        if not self.exchanges:
            return None

        def test(point: Solved) -> float:
            return float(balance(self.engine.spectrum(point.row)[None, :], self.kind)[0])

        if not test(segment.a) * test(segment.b) < 0.0:
            return None
        rough = locate(segment, test, tolerance=1e-6)
        if rough is None:
            return None
        count, _, _ = self._counts(rough.point)
        inner = abs(self._multiplier("plus", max(count, 1))(rough.point))
        if abs(test(rough.point)) > REACHED or (self.kind != "real" and inner > REACHED):
            return None
        if self._complex(segment, rough.point) or not passes_for_certain(segment, rough.position):
            return None
        root = locate_singular(segment, test, rough.position) or rough
        return self._located(root, "branch-point", 0)

    def _around(self, segment: Segment, fold: Located, before: list[int], after: list[int]) -> list[Located]:
        """Multipliers that pass the circle before a fold and come back behind it, so that the ends of the segment do not tell."""
        here = self._counts(fold.point)
        found: list[Located] = []
        for name, one, same, there in zip(NAMES, before, after, here):
            if name == "plus" or one != same:
                continue
            for k in range(min(one, there) + 1, max(one, there) + 1):
                for first, second, start, length in (
                    (segment.a, fold.point, 0.0, fold.position),
                    (fold.point, segment.b, fold.position, 1.0 - fold.position),
                ):
                    root = locate(Segment(self.engine, first, second), self._multiplier(name, k), jump=0.05)
                    if root is not None and root.continuous:
                        event = self._located(root, self._kind(name), k)
                        found.append(event._replace(position=start + length * root.position))
        return found

    def _complex(self, segment: Segment, point: Solved) -> bool:
        """Whether it was a pair that passed the axis, where only branch points are looked for."""
        if self.kind != "real":
            return False
        near, ends = (
            self.engine.spectrum(row) for row in (point.row, np.array([segment.a.row, segment.b.row]))
        )
        one = near[
            np.argmin(np.abs(near.real))
        ]  # the one that passes; another may be next to nothing all along
        unit = min(1.0, float(np.abs(ends).max())) if one.imag else 1.0
        return bool(abs(one) > REACHED * unit)

    def _counts(self, point: Solved) -> list[int]:
        """How many multipliers are past the circle; see :func:`counts_at`."""
        return counts_at(point.row[: 2 * self.engine.m].tolist(), self.kind)

    def _kind(self, name: str) -> str:
        if name == "minus":
            return self.engine.problem.flip_kind
        return "hopf" if self.kind == "flow" else "neimark-sacker"

    def _multiplier(self, name: str, k: int) -> Aim:
        return aim_at_multiplier(self.engine.m, self.kind, name, k)

    def _located(
        self, root: Root, kind: str, index: int, role: Role = Role.SPECIAL, name: str = ""
    ) -> Located:
        return Located(root.position, kind, index, root.point, NOWHERE, root.error, role, name)

    def _fold(self, segment: Segment, met: list[float]) -> list[Located]:
        one, other = float(segment.a.tangent[-1]), float(segment.b.tangent[-1])
        flat = max(abs(one), abs(other)) <= FLAT * self.engine.parameter_unit(segment.a.p)
        if flat or (one >= 0.0) == (other >= 0.0):
            return []
        root = locate(segment, AT_FOLDS)
        if root is None or not root.continuous:
            return []
        if _near(root.position, met, 0.02) or not self._returns(segment, root.point.p):
            return []
        return [self._located(root, "fold", 0)]

    def _returns(self, segment: Segment, p: float) -> bool:
        """Whether the parameter turns back by more than rounding; on a vertical branch it does not."""
        moved = max(abs(segment.a.p - p), abs(segment.b.p - p))
        return moved > max(ROUNDING, 10.0 * self.engine.noise) * self.engine.parameter_unit(p)

    def _regular(self, point: Solved) -> bool:
        """Whether the branch is alone at a point where a multiplier passes +1: the segment has led from one to another.

        Of a branch point the tangent leaves a null vector over; here [[F_u, F_p], [tangent]] is far from singular.
        """
        stationary = abs(point.tangent[-1]) <= STATIONARY * self.engine.parameter_unit(point.p)
        return stationary and not singular(self.engine, point)

    def _turns_back(self, segment: Segment, root: Root) -> bool:
        """Whether the parameter has an extremum where a multiplier passes +1, though the ends do not tell."""
        unit = self.engine.parameter_unit(root.point.p)
        if abs(root.point.tangent[-1]) > STATIONARY * unit:
            return False
        reach = min(BESIDE, 0.5 * root.position, 0.5 * (1.0 - root.position)) or BESIDE
        sides = segment.several((root.position - reach, root.position + reach))
        return (
            sides[0] is not None
            and sides[1] is not None
            and sides[0].tangent[-1] * sides[1].tangent[-1] < 0.0
        )

    def _sharpen(self, segment: Segment, crossings: list[Located]) -> list[Located]:
        """Branch points again, through interpolation; those at one and the same place from the mean of their tests."""
        result = [e for e in crossings if e.kind != "branch-point"]
        points = [e for e in crossings if e.kind == "branch-point"]
        while points:
            group = [e for e in points if abs(e.position - points[0].position) <= 1e-6]
            points = [e for e in points if e not in group]
            tests = [self._multiplier("plus", e.index) for e in group]
            gaps = [0.4 * abs(e.position - group[0].position) for e in points]
            mean = lambda point, tests=tests: sum(test(point) for test in tests) / len(tests)  # noqa: E731
            root = locate_singular(segment, mean, group[0].position, width=min([0.2, *gaps]))
            if self.kind == "real" and len(group) == 1:
                root = by_elimination(segment, root)
            for event in group:
                found = event if root is None else self._located(root, event.kind, event.index)
                result.append(blurred(segment, found, self._multiplier("plus", event.index)))
        return result

    def _meetings(self, segment: Segment) -> list[Located]:
        events = []
        for index, test in enumerate(self.symmetries):
            ends = test.part(np.array([segment.a.u, segment.b.u]))
            if not (ends[0] @ ends[1] < 0.0 and np.abs(ends).max(axis=1).min() > 1e-6):
                continue
            scale = float(np.sqrt(ends[0] @ ends[0]))

            def along(point: Solved, test: SymmetryTest = test, row: np.ndarray = ends[0] / scale) -> float:
                return float(row @ test.part(point.u[None, :])[0])

            first, last = along(segment.a), along(segment.b)
            rough = first / (first - last)
            root = locate_singular(segment, along, rough) or locate(segment, along)
            if root is not None:
                root = locate_singular(segment, along, root.position) or root
                at = test.symmetry.kind_at
                kind = self._where_singular(segment, root, test.kind if at is None else at(root.point.u))
                events.append(self._located(root, kind, index, Role.MEETING))
        return events

    def _where_singular(self, segment: Segment, root: Root, kind: str) -> str:
        """The kind of a branch point, or "astray" where it is none: the segment has led from one branch to another."""
        known = self.many or segment.length <= SHORTEST or singular(self.engine, root.point)
        return kind if known else "astray"

    def _borders(self, segment: Segment, real: bool) -> tuple[list[Located], Solved | None]:
        """The border of a segment, if there is one, and the point just before it."""
        border = find_border(segment, real)
        if border is None:
            return [], None
        root, index = border
        kind = self.engine.problem.margin_kind(index)
        point, before = one_sided(segment, root)
        blur = rounding(segment, root, index, before)
        found = Located(root.position, kind, index, point, NOWHERE, root.error, Role.BORDER, "", blur)
        return [found], before

    def examine_users(self, segment: Segment, values: Mapping[str, np.ndarray]) -> list[Located]:
        """Zeros of the user functions on one segment."""
        events = []
        for index, (name, ends) in enumerate(values.items()):
            if not changes(np.asarray(ends))[0]:
                continue
            f = self.users[name]
            root = locate(segment, lambda point, f=f: float(f(point.u[None, :], np.array([point.p]))[0]))
            if root is not None and root.continuous:
                role = Role.STOP if name in self.stops else Role.SPECIAL
                events.append(self._located(root, "user", index, role, name))
        return events

    def before(self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0) -> list[Located]:
        """The special points of the first part of a segment."""
        part = self.examine(Segment(self.engine, segment.a, middle), real, depth)
        return [e._replace(position=s * e.position) for e in part]

    def both(self, segment: Segment, s: float, middle: Solved, real: bool, depth: int = 0) -> list[Located]:
        """The special points of a segment from its two parts."""
        second = self.examine(Segment(self.engine, middle, segment.b), real, depth)
        return self.before(segment, s, middle, real, depth) + [
            e._replace(position=s + (1.0 - s) * e.position) for e in second
        ]


def changes(values: np.ndarray) -> np.ndarray:
    """Whether the sign changes between neighbours; an exact zero counts as positive."""
    positive = values >= 0.0
    return positive[:-1] != positive[1:]


def _near(position: float, others: list[float], distance: float = SAME) -> bool:
    return any(abs(position - other) <= distance for other in others)
