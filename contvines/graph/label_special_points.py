"""Marking: from located events to labelled special points, each listed once."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..bifurcation.kind_answers import classified
from ..bifurcation.kinds import BORDERS
from ..bifurcation.located import Located, Role
from ..bifurcation.location_error import missed, singular_within
from ..bifurcation.multiplier_counts import counts
from ..bifurcation.point_on_branch import PointOnBranch
from ..bifurcation.switching import null_vectors
from ..branches.assembly import a_sliver, stability
from ..branches.branch import Branch
from ..branches.ending import Ending, Reason
from ..branches.half_branch import HalfBranch
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN
from ..interrupts import OPEN
from ..problems.abilities import Adaptive, EndsOnMesh
from ..problems.protocol import Problem
from .identity import Place, same_form, same_value, turns_at
from .match_borders import is_border
from .run import Origin, Pending, Run
from .settings import IDENTITY
from .unresolved import Unresolved

TURNING_KINDS = ("branch-point", "symmetry-breaking")
LAST_PLACES = 8  # units in the last place of the parameter by which two values may differ by rounding alone


def mark(
    run: Run, engine: Engine, branch: Branch, half: HalfBranch, pending: Pending, origin: int | None
) -> list[SpecialPoint]:
    """Label the events and interval ends of a branch in order along it, `origin` among them; returns what is new on it."""
    marks: list[tuple[int, str]] = []
    fresh: list[SpecialPoint] = []
    ends: dict[int, Ending] = {}
    last = len(branch) - 1
    known = [pair for pair in half.events if pair[1].role is not Role.UNRESOLVED]
    events = _without_turnings(engine, known)
    if not branch.closed:
        for index, side in ((0, 0), (last, 1)):
            if branch.endings[side].reason is Reason.LEFT_INTERVAL:
                events.append((index, _end(engine, half, index)))
    reached = pending.kind in (Origin.SWITCH, Origin.REST) and not branch.closed
    if reached and origin is not None and pending.point is not None:
        marks.append((origin, pending.point))
    events.sort(key=lambda pair: pair[0])
    for index, event in events:
        meets = event.role is Role.MEETING
        kind = _kind(run, engine, event)
        label = _known(run, engine, branch, event, kind, pending, meets, index in (0, last))
        if label is None:
            point = _special(run, kind, engine, branch, event, index)
            label = point.label = run.new_label(run.kind(kind).label)
            run.events[label] = event
            run.graph.special[label] = point
            fresh.append(point)
        else:
            known = run.graph.special[label]
            if known in fresh and abs(known.index - index) <= 1:
                run.remark(label, "two multipliers cross at once")
                known.index = min(index, known.index)
                continue
            if meets:
                run.connect(label, known.branch, branch.label)
            elif known.kind in BORDERS:
                if known.multipliers_beyond is None and label == pending.point:
                    known.multipliers_beyond = engine.multipliers(event.point.row)
                if known.branch != branch.label:
                    run.connect(label, known.branch, branch.label)
            elif known.met_from is not None:
                # now seen on the branch of the more symmetric solutions: that one owns it
                point = _special(run, kind, engine, branch, event, index)
                point.label, run.events[label] = label, event
                point.met_from, point.remarks = known.met_from, known.remarks
                for other in run.graph.branches.values():
                    first, last = (_met(ending, label, branch.label) for ending in other.endings)
                    other.endings = (first, last)
                run.graph.special[label] = point
                fresh.append(point)
            elif known.branch != branch.label:
                run.connect(label, known.branch, branch.label)
        marks.append((index, label))
        if index in (0, last) and event.ends_branch:
            ending = _ending(run, label, kind, branch, meets)
            if event.role is Role.STOP:
                ending = replace(ending, reason=Reason.STOPS, text=event.name)
            ends[0 if index == 0 else 1] = ending
    branch.marks = tuple(sorted(marks))
    # a fold that is a branch point, or a second one that is the first, is no place at which stability changes
    places = {i for i, _ in marks} | ({origin} if origin is not None else set())
    stretches = [(i, event) for i, event in half.events if event.role is Role.UNRESOLVED]
    places |= {i for i, _ in stretches}
    twins = {i for i, _ in half.events} - places
    branch.stable = stability(engine, half.joined().spectrum, sorted(places), sorted(twins))
    own = [(_stretch(engine, branch, half, *pair), _accuracy(engine, pair[1].point)) for pair in stretches]
    run.graph.unresolved += _unresolved(run, branch, own)
    branch.endings = (ends.get(0, branch.endings[0]), ends.get(1, branch.endings[1]))
    return fresh


class _Place(NamedTuple):
    """A special point, or a stretch that is not resolved: its index on the branch, values between which it lies, and the error of these."""

    at: int
    low: float
    high: float
    error: float
    what: SpecialPoint | Unresolved


def _unresolved(run: Run, branch: Branch, stretches: list[tuple[Unresolved, float]]) -> list[Unresolved]:
    """What is not resolved: stretches, those that are one as far as their values are known joined, and special points that cannot be told apart.

    Solutions between places whose values are one, or between which no solution could be put, count as unstable where those on both sides are.
    """
    points = [(i, run.graph.special[label]) for i, label in branch.marks]
    places = [_Place(i, point.value, point.value, point.location_error, point) for i, point in points]
    places += [_Place(one.index, one.low, one.high, error, one) for one, error in stretches]
    places.sort(key=lambda place: place.at)
    found = [one for one, _ in stretches]
    groups = [[place] for place in places[:1]]
    for one, other in pairwise(places):
        apart = max(one.low, other.low) - min(one.high, other.high)
        rounding = LAST_PLACES * float(np.spacing(run.unit(one.low)))
        if not _may_hide(one, other) or (
            other.at - one.at > 1 and apart > one.error + other.error + rounding
        ):
            groups.append([other])
            continue
        groups[-1].append(other)
        if isinstance(one.what, SpecialPoint) and isinstance(other.what, SpecialPoint):
            names = one.what.label, other.what.label
            for label, neighbour in (names, names[::-1]):
                run.remark(label, f"{apart:.1e} from {neighbour}: solutions between the two are not resolved")
            low, high = sorted((one.low, other.low))
            found.append(Unresolved(branch.label, low, high, one.at, "neighbours", points=names))
    for group in groups:
        inside = [place.what for place in group if isinstance(place.what, Unresolved)]
        if len(inside) > 1:
            found = [one for one in found if one not in inside]
            low, high = min(one.low for one in inside), max(one.high for one in inside)
            found.append(replace(inside[0], low=low, high=high, after=inside[-1].after))
        beside = [k for k in (group[0].at - 1, group[-1].at + 1) if 0 <= k < len(branch)]
        if len(group) > 1 and branch.stable is not None and not branch.stable[beside].any():
            branch.stable[group[0].at : group[-1].at + 1] = False
    return found


def _may_hide(one: _Place, other: _Place) -> bool:
    """Whether solutions between two places may be stable although those on both sides are not."""
    if isinstance(one.what, SpecialPoint) and isinstance(other.what, SpecialPoint):
        return a_sliver((one.what.kind,), (other.what.kind,))
    return True


def _accuracy(engine: Engine, point: Solved) -> float:
    """How well the equations know the parameter at a point."""
    problem = engine.problem
    own = problem.accuracy(point.u, point.p) if isinstance(problem, Adaptive) else 0.0
    return max(own, problem.uncertainty()) * engine.parameter_unit(point.p)


def _stretch(engine: Engine, branch: Branch, half: HalfBranch, index: int, event: Located) -> Unresolved:
    """A stretch whose ends do not agree with what was found between them; the points beside it tell what is certain."""
    rows = half.joined().spectrum[[max(index - 1, 0), min(index + 1, len(branch) - 1)]]
    before, after = (tuple(found) for found in counts(engine, rows).tolist())
    low, high = sorted(event.bracket)
    reason = event.name or ("determinant" if before == after else "multipliers")
    return Unresolved(branch.label, low, high, index, reason, before, after)


def origin_index(half: HalfBranch, pending: Pending) -> int | None:
    """Index of the special point from which the branch was reached, if it is one of its points."""
    if pending.origin is None:
        return None
    whole = half.joined()
    for i in np.flatnonzero(whole.values == pending.origin.p):
        if np.array_equal(whole.points[i], pending.origin.u):
            return int(i)
    return None


def _end(engine: Engine, half: HalfBranch, index: int) -> Located:
    u, p, tangent = half.at(index)
    bound = engine.upper if abs(p - engine.upper) < abs(p - engine.lower) else engine.lower
    point = engine.polish(u, p, engine.at_parameter, p, tangent)
    if point is None:  # by chance the equations end just there, and cannot be differentiated
        row = np.full(engine.row_size, np.nan)
        row[: 2 * engine.m] = half.joined().spectrum[index]
        point = Solved(u, p, tangent, row, 1.0, 0.0, 0.0)
    return Located(float(index), "end", 0, point, (bound, bound), 0.0)


def _kind(run: Run, engine: Engine, event: Located) -> str:
    """The kind of an event; a branch point is classed by the symmetry of its null vector.

    The image of a single null vector is that vector or its opposite, and the nearer of both: beside homoclinic orbits it is known to few digits.
    """
    if event.kind != "branch-point":
        return event.kind
    for test in run.engine(engine.problem)[1].symmetries:
        if np.abs(test.part(event.point.u[None, :], [event.point.p])).max() > engine.settings.symmetric:
            continue
        vectors = null_vectors(engine, event.point.u, event.point.p, event.point.tangent)
        for u in (vector[:-1] for vector in vectors):
            image = test.image_direction(event.point.u, u)
            itself = np.abs(image - u).max() if len(vectors) == 1 else engine.settings.aside * np.abs(u).max()
            if np.abs(image + u).max() < itself:
                return test.kind
    return event.kind


def _known(
    run: Run,
    engine: Engine,
    branch: Branch,
    event: Located,
    kind: str,
    pending: Pending,
    meets: bool,
    at_end: bool,
) -> str | None:
    problem, point = engine.problem, event.point
    if kind == "end":
        return None
    if kind in BORDERS and at_end and pending.kind is Origin.BORDER and pending.point is not None:
        source = run.graph.special[pending.point]
        gaps = np.abs(branch.values[[0, -1]] - source.value)
        home = abs(source.value - point.p) <= gaps.min()  # the other end is a border of its own, however near
        if home and is_border(run, problem, event, source.label):
            return source.label
    if kind in BORDERS and at_end:
        for other in run.queue:
            if other.kind is not Origin.BORDER or other.point is None:
                continue
            if not is_border(run, problem, event, other.point):
                continue
            found = run.register.find(other.problem, other.u, other.p)
            if found is not None and found.label == branch.label:
                other.reached = branch.real
                return other.point
    form, beside, near = None, [], IDENTITY.unstated * run.settings.same * run.unit(point.p)
    for known in run.graph.special.values():
        if known.kind != kind or abs(known.value - point.p) > near or known.problem is None:
            continue
        if kind == "user" and known.name != event.name:
            continue
        form = problem.canonical(point.u, point.p) if form is None else form
        if same_form(form, run.form(known), engine.scale, run.settings.same):
            return known.label
        if not meets or known.branch == branch.label:
            continue
        places = Place(known.value, known.location_error), Place(float(point.p), event.error)
        if same_value(*places, run.unit(point.p), run.settings.same):
            beside.append((abs(known.value - point.p), known.label))
    # one point seen in two problems, whose forms need not agree: the nearest of those whose values agree as far as they are known
    return min(beside)[1] if beside else None


def _without_turnings(engine: Engine, events: list[tuple[int, Located]]) -> list[tuple[int, Located]]:
    """Events of one branch without folds that are its own branch points: a side branch only turns there."""
    places = [event.point for _, event in events if event.kind in TURNING_KINDS]
    return [
        (index, event)
        for index, event in events
        if event.kind != "fold"
        or not any(turns_at(engine, event.point, place.u, place.p) for place in places)
    ]


def _doubt(engine: Engine, special: SpecialPoint) -> None:
    """Carry the accuracy of the equations into that of the location, and look whether given derivatives are right here."""
    problem = engine.problem
    if special.kind == "end":
        return
    special.location_error = max(
        special.location_error, problem.uncertainty() * engine.parameter_unit(special.value)
    )
    if isinstance(problem, Adaptive):
        from ..bifurcation.mesh_error import mesh_error

        own = mesh_error(engine, special)
        if own is None:
            own = problem.accuracy(special.u, special.value) * engine.parameter_unit(special.value)
        special.location_error = max(special.location_error, own)
    if isinstance(problem, EndsOnMesh):
        if special.kind == "homoclinic":
            special.location_error = max(
                special.location_error, problem.remaining(special.u, special.tangent)
            )
        elif special.margin_index is not None:
            special.location_error = max(special.location_error, problem.touch_error(special))
    if special.kind == "branch-point":
        where = engine, special.u, special.value, special.tangent
        within = max(singular_within(*where), 2.0 * missed(*where))
        special.location_error = max(special.location_error, within)
    wrong = problem.check(special.u, special.value)
    if wrong is not None:
        special.remarks = (*special.remarks, str(wrong))
        special.location_error = float("inf")


def _special(run: Run, kind: str, engine: Engine, branch: Branch, event: Located, index: int) -> SpecialPoint:
    """A point that has no label yet."""
    point = event.point
    margins = float(engine.smallest_margin(point.row))
    special = SpecialPoint(
        label="",
        kind=kind,
        branch=branch.label,
        value=float(point.p),
        parameter=branch.parameter,
        u=np.array(point.u),
        tangent=np.array(point.tangent),
        multipliers=engine.multipliers(point.row),
        margins=margins,
        bracket=event.bracket,
        residual=float(point.residual),
        location_error=float(event.error),
        real=branch.real or margins >= MARGIN,
        name=event.name,
        margin_index=int(event.index) if kind in BORDERS else None,
        index=index,
        problem=engine.problem,
        own_kind=run.kind(kind) if run.kind(kind).test else None,
    )
    special.replay = partial(_replay, engine.problem, special.u, special.value) if special.real else None
    _doubt(engine, special)
    if event.role is Role.MEETING:
        special.met_from = branch.label
    form = classified(run.kind(kind), PointOnBranch(engine, point), {special.parameter: special.value})
    special.criticality, special.coefficient, remarks = form
    special.remarks = (*special.remarks, *remarks)
    return special


def _replay(problem: Problem, u: np.ndarray, p: float) -> float | None:
    """Deviation of a simulation from the solution; None where there is none."""
    with OPEN:
        error = problem.replay(u, p)
    return None if error is None else float(error)


def _ending(run: Run, label: str, kind: str, branch: Branch, meets: bool) -> Ending:
    known = run.graph.special[label]
    own = known.branch == branch.label
    if meets:
        reason = Reason.COMES_BACK if own else Reason.MEETS_SYMMETRIC
    else:
        reason = Reason.REACHES if own else Reason.MEETS
    return Ending(reason, known.value, label, None if own else known.branch, kind)


def _met(ending: Ending, label: str, owner: str) -> Ending:
    """An ending at a point of more symmetric solutions, whose branch is known now."""
    if ending.reason is Reason.COMES_BACK and ending.point == label:
        return replace(ending, reason=Reason.MEETS_SYMMETRIC, other=owner)
    return ending
