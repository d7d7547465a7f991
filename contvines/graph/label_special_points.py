"""Label special points: turn the located events of a branch into special points of the graph, each listed once."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..bifurcation.kind import PointOnBranch, classified
from ..bifurcation.kinds import BORDERS
from ..bifurcation.locate import Located, Role
from ..bifurcation.location_error import mesh_error, missed, singular_within
from ..bifurcation.scan import counts
from ..bifurcation.switching import null_vectors
from ..branches import Branch, Ending, Reason
from ..branches.half_branch import HalfBranch, may_be_stable_between, stability
from ..branches.special_point import SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN
from ..long_work import OPEN
from ..problems.abilities import Adaptive, EndsOnMesh
from ..problems.protocol import Problem
from .contents import Unresolved
from .identity import IDENTITY, Place, same_form, same_value, turns_at
from .match_borders import is_border
from .run import Origin, Pending, Run

TURNING_KINDS = ("branch-point", "symmetry-breaking")
LAST_PLACES = 8  # two parameter values may differ by this many units in the last place through rounding


def mark(
    run: Run, branch: Branch, half: HalfBranch, pending: Pending, origin: int | None
) -> list[SpecialPoint]:
    """Label the events and interval ends of a branch, in order along it, and determine its stability.

    Parameters
    ----------
    run : Run
    branch : Branch
        Its marks, endings and stability are set.
    half : HalfBranch
        Points and events of the branch.
    pending : Pending
        The pending branch from which it was traced.
    origin : int or None
        Index of the special point from which the branch was reached; see `origin_index`.

    Returns
    -------
    list of SpecialPoint
        The new special points.
    """
    engine, last, marking = half.engine, len(branch) - 1, _Marking(run, branch, half, pending)
    marks: list[tuple[int, str]] = []
    fresh: list[SpecialPoint] = []
    ends = list(branch.endings)
    stretches = [(i, event) for i, event in half.events if event.role is Role.UNRESOLVED]
    # at a branch point a side branch turns: this is no fold of its own
    resolved = [(i, event) for i, event in half.events if event.role is not Role.UNRESOLVED]
    turning = [event.point for _, event in resolved if event.kind in TURNING_KINDS]
    events = [
        (i, event)
        for i, event in resolved
        if event.kind != "fold" or not any(turns_at(engine, event.point, at.u, at.p) for at in turning)
    ]
    if not branch.closed:
        left = [branch.endings[side].reason is Reason.LEFT_INTERVAL for side in (0, 1)]
        events += [(index, marking.end(index)) for index, leaves in zip((0, last), left) if leaves]
    reached = pending.kind in (Origin.SWITCH, Origin.REST) and not branch.closed
    if reached and origin is not None and pending.point is not None:
        marks.append((origin, pending.point))
    taken = False
    for index, event in sorted(events, key=lambda pair: pair[0]):
        meets, kind = event.role is Role.MEETING, marking.kind(event)
        # after a doubled branch that returned here, a border at the end is not compared with known ones: this branch's border is its own
        label = marking.known_label(event, kind, index == 0 or (index == last and not taken))
        if label is None:
            label = run.new_label(run.kind(kind).label)
            fresh.append(marking.special(label, kind, event, index))
        else:
            point = run.graph.special[label]
            if point in fresh and abs(point.index - index) <= 1:
                run.remark(label, "two multipliers cross at once")
                point.index = min(index, point.index)
                continue
            if not meets and point.kind not in BORDERS and point.met_from is not None:
                # the point was found first by a less symmetric branch; now it is put on the branch of the more symmetric solutions
                taken = True
                fresh.append(marking.special(label, kind, event, index, point))
                for other in run.graph.branches.values():
                    first, final = (_joined_branch(ending, label, branch.label) for ending in other.endings)
                    other.endings = (first, final)
            else:
                if point.kind in BORDERS and point.multipliers_beyond is None and label == pending.point:
                    point.multipliers_beyond = engine.multipliers(event.point.row)
                if meets or point.branch != branch.label:
                    run.connect(label, point.branch, branch.label)
        marks.append((index, label))
        if index in (0, last) and event.ends_branch:
            ends[0 if index == 0 else 1] = marking.ending(label, kind, event)
    branch.marks, branch.endings = tuple(sorted(marks)), (ends[0], ends[1])
    # stability does not change at events without a mark of their own: folds at branch points, points located twice
    places = {i for i, _ in marks + stretches} | ({origin} if origin is not None else set())
    twins = {i for i, _ in half.events} - places
    branch.stable = stability(engine, half.joined().spectrum, sorted(places), sorted(twins))
    unresolved = [(marking.stretch(*pair), _accuracy(engine, pair[1].point)) for pair in stretches]
    run.graph.unresolved += _unresolved(run, branch, unresolved)
    return fresh


class _Marking(NamedTuple):
    """Functions for labelling the special points of one branch."""

    run: Run
    branch: Branch
    half: HalfBranch
    pending: Pending

    @property
    def engine(self) -> Engine:
        return self.half.engine

    def end(self, index: int) -> Located:
        """Return the event "end of the interval" at an end of the branch."""
        engine, (u, p, tangent) = self.engine, self.half.at(index)
        bound = engine.upper if abs(p - engine.upper) < abs(p - engine.lower) else engine.lower
        point = engine.polish(u, p, engine.at_parameter, p, tangent)
        if point is None:  # by chance the equations end exactly there, and cannot be differentiated
            row = np.full(engine.row_size, np.nan)
            row[: 2 * engine.m] = self.half.joined().spectrum[index]
            point = Solved(u, p, tangent, row, 1.0, 0.0, 0.0)
        return Located(float(index), point, "end", bracket=(bound, bound))

    def stretch(self, index: int, event: Located) -> Unresolved:
        """Return the unresolved stretch of an event, with the counts of multipliers at the points beside it."""
        rows = self.half.joined().spectrum[[max(index - 1, 0), min(index + 1, len(self.branch) - 1)]]
        before, after = (tuple(found) for found in counts(self.engine, rows).tolist())
        low, high = sorted(event.bracket)
        reason = event.name or ("determinant" if before == after else "multipliers")
        return Unresolved(self.branch.label, low, high, index, reason, before, after)

    def kind(self, event: Located) -> str:
        """Return the kind of an event. A branch point whose null vector is changed in sign by a symmetry has the kind of this symmetry.

        The image of a single null vector is the vector or its opposite; the nearer one is taken, as beside homoclinic orbits it has few digits.
        """
        if event.kind != "branch-point":
            return event.kind
        engine, point = self.engine, event.point
        for test in self.half.detector.symmetries:
            if np.abs(test.part(point.u[None, :], [point.p])).max() > engine.settings.symmetric:
                continue
            vectors = null_vectors(engine, point.u, point.p, point.tangent)
            for u in (vector[:-1] for vector in vectors):
                image = test.image_direction(point.u, u)
                tolerance = engine.settings.aside * np.abs(u).max()
                if np.abs(image + u).max() < (np.abs(image - u).max() if len(vectors) == 1 else tolerance):
                    return test.kind
        return event.kind

    def known_label(self, event: Located, kind: str, at_end: bool) -> str | None:
        """Return the label of a known special point that is the same as an event; None if there is none.

        `at_end` says that the event is at an end of the branch: borders are then compared with those that lead to this branch.
        """
        run, engine, problem, point = self.run, self.engine, self.engine.problem, event.point
        special, pending, unit = run.graph.special, self.pending, run.unit(event.point.p)
        if kind == "end":
            return None
        if kind in BORDERS and at_end:
            if pending.kind is Origin.BORDER and pending.point is not None:
                source = special[pending.point]
                gaps = np.abs(self.branch.values[[0, -1]] - source.value)
                home = (
                    abs(source.value - point.p) <= gaps.min()
                )  # False if the other end of the branch is nearer to the source: this end is another border
                if home and is_border(run, problem, event, source.label):
                    return source.label
            for other in run.queue:
                if (
                    other.kind is Origin.BORDER
                    and other.point
                    and is_border(run, problem, event, other.point)
                ):
                    found = run.register.find(other.problem, other.u, other.p)
                    if found is not None and found.label == self.branch.label:
                        other.reached = self.branch.real
                        return other.point
        form, candidates, near = None, [], IDENTITY.unstated * run.settings.same * unit
        for earlier in special.values():
            if earlier.kind != kind or abs(earlier.value - point.p) > near or earlier.problem is None:
                continue
            if kind == "user" and earlier.name != event.name:
                continue
            form = problem.canonical(point.u, point.p) if form is None else form
            if same_form(form, run.form(earlier), engine.scale, run.settings.same):
                return earlier.label
            if event.role is Role.MEETING and earlier.branch != self.branch.label:
                places = Place(earlier.value, earlier.location_error), Place(float(point.p), event.error)
                if same_value(*places, unit, run.settings.same):
                    candidates.append((abs(earlier.value - point.p), earlier.label))
        # one point of two problems, whose canonical forms may differ: the nearest of those with the same value within the errors
        return min(candidates)[1] if candidates else None

    def special(
        self, label: str, kind: str, event: Located, index: int, earlier: SpecialPoint | None = None
    ) -> SpecialPoint:
        """Make a special point and add it to the graph.

        `earlier` is the same point found before from a branch of less symmetric solutions; it is replaced.
        """
        run, branch, engine, point = self.run, self.branch, self.engine, event.point
        margins, problem = float(engine.smallest_margin(point.row)), engine.problem
        special = SpecialPoint(
            label=label,
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
            problem=problem,
            own_kind=run.kind(kind) if run.kind(kind).test else None,
        )
        special.replay = partial(_replay, problem, special.u, special.value) if special.real else None
        if kind != "end":
            special.location_error = max(_errors(engine, special))
            wrong = problem.check(special.u, special.value)  # are the given derivatives right here?
            if wrong is not None:
                special.remarks, special.location_error = (str(wrong),), float("inf")
        if event.role is Role.MEETING:
            special.met_from = branch.label
        form = classified(run.kind(kind), PointOnBranch(engine, point))
        special.criticality, special.coefficient, remarks = form
        special.remarks = (*special.remarks, *remarks)
        if earlier is not None:
            special.met_from, special.remarks = earlier.met_from, earlier.remarks
        run.events[label], run.graph.special[label] = event, special
        return special

    def ending(self, label: str, kind: str, event: Located) -> Ending:
        """Return the ending of the branch at a special point."""
        point = self.run.graph.special[label]
        on_branch = point.branch == self.branch.label
        if event.role is Role.MEETING:
            reason = Reason.COMES_BACK if on_branch else Reason.MEETS_SYMMETRIC
        else:
            reason = Reason.REACHES if on_branch else Reason.MEETS
        found = Ending(reason, point.value, label, None if on_branch else point.branch, kind)
        return replace(found, reason=Reason.STOPS, text=event.name) if event.role is Role.STOP else found


def _joined_branch(ending: Ending, label: str, owner: str) -> Ending:
    """Return an ending with the branch of more symmetric solutions, now known, if it lies at this point."""
    if ending.reason is Reason.COMES_BACK and ending.point == label:
        return replace(ending, reason=Reason.MEETS_SYMMETRIC, other=owner)
    return ending


def _errors(engine: Engine, special: SpecialPoint) -> list[float]:
    """Return the errors of a location: of the zero, of the equations, of their mesh, of a singular matrix."""
    problem, unit = engine.problem, engine.parameter_unit(special.value)
    errors = [special.location_error, problem.uncertainty() * unit]
    if isinstance(problem, Adaptive):
        of_mesh = mesh_error(engine, special)
        errors.append(problem.accuracy(special.u, special.value) * unit if of_mesh is None else of_mesh)
    if isinstance(problem, EndsOnMesh):
        if special.kind == "homoclinic":
            errors.append(problem.remaining(special.u, special.tangent))
        elif special.margin_index is not None:
            errors.append(problem.touch_error(special))
    if special.kind == "branch-point":
        at_point = engine, special.u, special.value, special.tangent
        errors += [singular_within(*at_point), 2.0 * missed(*at_point)]
    return errors


def _replay(problem: Problem, u: np.ndarray, p: float) -> float | None:
    """Return the deviation of a simulation from the solution; None for problems without simulation."""
    with OPEN:
        error = problem.replay(u, p)
    return None if error is None else float(error)


def origin_index(half: HalfBranch, pending: Pending) -> int | None:
    """Return the index of the special point from which the branch was reached, if it is one of its points, else None."""
    if pending.origin is None:
        return None
    whole = half.joined()
    for i in np.flatnonzero(whole.values == pending.origin.p):
        if np.array_equal(whole.points[i], pending.origin.u):
            return int(i)
    return None


# ------------------------------------------------------------------ unresolved stretches
def _accuracy(engine: Engine, point: Solved) -> float:
    """Return the error of the parameter at a point, from the equations and their mesh."""
    problem = engine.problem
    accuracy = problem.accuracy(point.u, point.p) if isinstance(problem, Adaptive) else 0.0
    return max(accuracy, problem.uncertainty()) * engine.parameter_unit(point.p)


class _Place(NamedTuple):
    """A special point or an unresolved stretch: its index on the branch, its interval of parameter values, and their error."""

    at: int
    low: float
    high: float
    error: float
    subject: SpecialPoint | Unresolved


def _unresolved(run: Run, branch: Branch, stretches: list[tuple[Unresolved, float]]) -> list[Unresolved]:
    """Return the unresolved stretches of a branch, and those between special points that cannot be distinguished.

    Stretches whose values are equal within their errors are joined. Solutions between points with equal values, or without a solved point between
    them, count as unstable if those on both outer sides are.

    Parameters
    ----------
    run : Run
    branch : Branch
        Its stability may be changed.
    stretches : list of (Unresolved, float)
        Stretches found by detection, and the error of their values.
    """
    points = [(i, run.graph.special[label]) for i, label in branch.marks]
    places = [_Place(i, point.value, point.value, point.location_error, point) for i, point in points]
    places += [_Place(one.index, one.low, one.high, error, one) for one, error in stretches]
    places.sort(key=lambda place: place.at)
    found = [one for one, _ in stretches]
    groups = [[place] for place in places[:1]]
    for one, other in pairwise(places):
        gap = max(one.low, other.low) - min(one.high, other.high)
        rounding = LAST_PLACES * float(np.spacing(run.unit(one.low)))
        if not _may_hide(one, other) or (other.at - one.at > 1 and gap > one.error + other.error + rounding):
            groups.append([other])
            continue
        groups[-1].append(other)
        if isinstance(one.subject, SpecialPoint) and isinstance(other.subject, SpecialPoint):
            names = one.subject.label, other.subject.label
            for label, neighbour in (names, names[::-1]):
                run.remark(label, f"{gap:.1e} from {neighbour}: solutions between the two are not resolved")
            low, high = sorted((one.low, other.low))
            found.append(Unresolved(branch.label, low, high, one.at, "neighbours", points=names))
    for group in groups:
        inside = [place.subject for place in group if isinstance(place.subject, Unresolved)]
        if len(inside) > 1:
            found = [one for one in found if one not in inside]
            low, high = min(one.low for one in inside), max(one.high for one in inside)
            found.append(replace(inside[0], low=low, high=high, after=inside[-1].after))
        neighbours = [k for k in (group[0].at - 1, group[-1].at + 1) if 0 <= k < len(branch)]
        if len(group) > 1 and branch.stable is not None and not branch.stable[neighbours].any():
            branch.stable[group[0].at : group[-1].at + 1] = False
    return found


def _may_hide(one: _Place, other: _Place) -> bool:
    """Whether solutions between two places may be stable although those on both outer sides are not."""
    if isinstance(one.subject, SpecialPoint) and isinstance(other.subject, SpecialPoint):
        return may_be_stable_between((one.subject.kind,), (other.subject.kind,))
    return True
