"""How the special points of one kind are followed in the plane of two parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME, checked
from ..bifurcation.located import Located, Role
from ..branches.assembly import make_branch
from ..branches.branch import Branch
from ..branches.ending import Ending
from ..branches.half_branch import HalfBranch
from ..branches.special_point import SpecialPoint
from ..branches.tracing import trace_half
from ..continuation.chunk import Status
from ..continuation.engine import Solved
from ..continuation.settings import Settings, hinting
from ..continuation.starts import check_interval
from ..interrupts import listening
from ..journal import NullJournal
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..problems.registry import without_problem
from ..shared.number_text import number_text
from .adaptive import AdaptiveLocus
from .codimension_two import becomes, beginning, vanishing
from .homoclinic import homoclinic_of
from .layout import BRANCH, MARGIN, PERIOD
from .locus import Locus, Turn
from .long_period import lengthened, limit_of, with_suited_period
from .on_mesh import on_mesh
from .own_test import of_own_kind, with_condition
from .plane_point import PlanePoint
from .problem import LocusProblem
from .settings import VANISHING
from .sides import impossible_side
from .starts import begin, first_point, regular_side

if TYPE_CHECKING:
    from ..journal import Journal

NOTHING = np.zeros(0), 0.0, 0.0, 0.0  # of a point of which no more is known
#: how a half may end where equations become singular
SINGULAR = (
    Status.STEP_TOO_SMALL,
    Status.NOT_EVALUABLE,
    Status.CREEPING,
    Status.BORDER,
    Status.COARSE,
)


@hinting
@listening()
def locus(
    point: SpecialPoint | PlanePoint,
    over: str,
    within: tuple[float, float],
    bounds: tuple[float, float] | None = None,
    virtual: bool = False,
    settings: Settings | Mapping[str, Any] | None = None,
    progress: Callable[[str, int, float], None] | None = None,
    period: float | None = None,
    kinds: Iterable[Kind] | None = None,
) -> Locus:
    """Follow a special point of any kind in a second parameter.

    Parameters
    ----------
    point : SpecialPoint or PlanePoint
        Fold, symmetry breaking, branch point, period doubling, Neimark-Sacker, Hopf, any border, or a homoclinic end of a branch of
        cycles of a flow. Of a Bogdanov-Takens point of a flow, on another locus, the homoclinic orbits that begin there are followed.
    over : str
        Name of the second parameter.
    within : (float, float)
        Its interval; it must hold the value at which the diagram was made.
    bounds : (float, float), optional
        Interval of the first parameter, at whose ends the locus ends; unbounded if left out.
    virtual : bool
        Go on where the motion ceases to exist (such points have ``real`` False).
    settings : Settings or mapping, optional
    progress : callable, optional
        Called with (label, number of points, value of the second parameter).
    period : float, optional
        Of a homoclinic end: the period of the cycles that stand for the homoclinic orbits along the locus; the one at the end of
        the branch if it is left out, of a heteroclinic cycle a shorter one, at a Bogdanov-Takens point one that suits the first orbit.
    kinds : iterable of Kind, optional
        As in :func:`contvines.diagram`: zeros of the tests of kinds of your own along the locus are among its points, too.

    Returns
    -------
    Locus

    Raises
    ------
    ValueError
        If the point has no locus, or a parameter or interval will not do; the sentence says why.
    """
    if point.kind in ("end", "user"):
        raise ValueError(f"{point.label} is no special point of the motion ({point.kind}); it has no locus")
    if point.problem is None:
        raise ValueError(without_problem(point.label))
    within = check_interval(within)
    own_kinds = tuple(kind for kind in checked(kinds) if BY_NAME.get(kind.name) is not kind)
    beside = isinstance(point, PlanePoint)
    if isinstance(point, PlanePoint):
        point = _beside(point, over, within, (-np.inf, np.inf) if bounds is None else check_interval(bounds))
    if period is not None:
        if point.kind != "homoclinic":
            raise ValueError(
                f"period = {period!r}: {point.label} is no homoclinic end of a branch ({point.kind})"
            )
        try:
            longer, u, p = lengthened(on_mesh(point.attached), np.array(point.u), float(point.value), period)
        except ValueError as error:
            raise ValueError(f"{point.label}: {error}") from error
        point = replace(point, problem=longer, u=u, value=p)
    elif not beside:
        point = with_suited_period(point)
    if not of_own_kind(point):
        point = regular_side(point)
    motion = point.attached
    known = motion.parameters
    own = of_own_kind(point)
    base: Any = with_condition(motion, point.own_kind, point.label) if own else motion
    problem = begin(
        base,
        point.kind,
        point.u,
        point.value,
        over,
        int(motion.n_margins) if own else point.margin_index or 0,
        (-np.inf, np.inf) if bounds is None else check_interval(bounds),
    )
    q = known[over]
    if not within[0] <= q <= within[1]:
        raise ValueError(
            f"the diagram was made at {over} = {q:.10g}, outside of within = [{within[0]:.10g}, {within[1]:.10g}]; "
            "widen the interval"
        )
    checked_ends(motion, over, within)
    settings = Settings.of(settings)
    found = trace_locus(
        problem,
        point.u,
        point.value,
        q,
        within,
        settings,
        label=point.label,
        seed=point.label,
        virtual=virtual,
        progress=progress,
    )
    if found is None:
        raise ValueError(
            f"the locus of {point.label} cannot be started: its equations do not converge at {over} = {q:.10g}"
        )
    found.kinds = own_kinds
    return found


def _beside(
    point: PlanePoint, over: str, within: tuple[float, float], bounds: tuple[float, float]
) -> SpecialPoint:
    """The homoclinic orbit beside a Bogdanov-Takens point of a flow."""
    if point.kind != "bogdanov-takens":
        raise ValueError(
            f"{point.label} is a point of codimension two ({point.kind}); only Bogdanov-Takens points of flows begin loci by themselves"
        )
    if over != point.parameters[1]:
        raise ValueError(f"over = {over!r}: {point.label} lies on a locus over {point.parameters[1]!r}")
    found = next(homoclinic_of(point, bounds, within), None)
    if found is None:
        raise ValueError(f"no homoclinic orbit is found beside {point.label}")
    nothing = np.zeros(len(found.u) + 1)
    label, kind, inner = point.label, found.kind, point.parameters[0]
    return SpecialPoint(label, kind, "", found.p, inner, found.u, nothing, np.zeros(0), problem=found.problem)


def checked_ends(problem: Problem, over: str, within: tuple[float, float]) -> None:
    """Refuse an interval whose ends are no sensible values of the parameter, where the problem can tell."""
    for value in within:
        problem.check_value(over, value)


class TooCoarse(Exception):
    """A locus asks for more intervals."""


def trace_locus(
    problem: LocusProblem,
    u: np.ndarray,
    p: float,
    q: float,
    within: tuple[float, float],
    settings: Settings,
    label: str,
    seed: str | None = None,
    virtual: bool = False,
    journal: Journal | None = None,
    progress: Callable[[str, int, float], None] | None = None,
    finer: int = 0,
) -> Locus | None:
    """The locus through a special point, both ways; None if its equations do not converge there.

    Where a mesh is too coarse all is done again with twice as many intervals, `finer` times so far.
    """
    name = f"locus/{label}/finer {finer}" if finer else f"locus/{label}"
    engine, start = first_point(problem, u, p, q, within, settings)
    if start is None:
        return None
    detector = Detector(engine)
    journal = NullJournal() if journal is None else journal
    own = int(problem.base.n_margins)
    margins = engine.margins(start.row)
    real = not np.any(margins[:own] < -VANISHING.margin)

    def notice(points: int, value: float) -> None:
        if progress is not None:
            progress(label, points, value)

    def go(first: Solved, side: str) -> tuple[HalfBranch, np.ndarray, str, PlanePoint | None]:
        now, half = real, None
        flags = np.zeros(0, dtype=bool)
        for part in range(20):
            more = trace_half(engine, first, detector, journal, f"{name}/{side}/{part}", now, None, notice)
            if more.status == Status.COARSE and _becoming(problem, more, within)[1] is None:
                raise TooCoarse
            flags = np.append(flags, np.full(len(more) - (0 if half is None else 1), now))
            half = more if half is None else half.extended(more, skip=1)
            border = _border(more)
            if border is None or not virtual or problem.margin_kind(border.index) in ("end", "resonance"):
                break
            now, first = not now, border.point
        assert half is not None
        became, end = _becoming(problem, half, within)
        return half, flags, became or _sentence(problem, half), end

    if start.tangent[-1] < 0.0:
        start = start._replace(tangent=-start.tangent, sign=-start.sign)
    first = None
    try:
        ahead, ahead_real, ahead_ended, last = go(start, "ahead")
        if ahead.status == Status.CLOSED:
            whole, flags, ended = ahead, ahead_real, (ahead_ended, ahead_ended)
        else:
            turned = start._replace(tangent=-start.tangent, sign=-start.sign)
            back, back_real, back_ended, first = go(turned, "back")
            whole = back.reversed().extended(ahead, skip=1)
            flags = np.append(back_real[::-1], ahead_real[1:])
            ended = (back_ended, ahead_ended)
    except TooCoarse:
        assert isinstance(problem, AdaptiveLocus)
        u, problem = problem.mesh.halved(u), problem.refined()
        return trace_locus(
            problem, u, p, q, within, settings, label, seed, virtual, journal, progress, finer + 1
        )
    endings = (Ending.said(ended[0]), Ending.said(ended[1]))
    branch = make_branch(label, whole, real, endings, ahead.status == Status.CLOSED, seed)
    branch.description["unfolded"] = problem.unfolded
    for index, end in ((0, first), (-1, last)):
        if end is not None:
            _put_at_end(problem, branch, index, end)
    if problem.condition == BRANCH and _unfolds(problem, branch.points):
        return None
    turns = tuple(
        Turn(i, (float(problem.split(e.point.u)[1]), float(e.point.p)))
        for i, e in whole.events
        if e.kind == "fold"
    )
    side = impossible_side(problem, branch) if problem.condition == MARGIN else 0
    limit = _limit(problem, start) if problem.condition == PERIOD else ""
    about = label, problem.kind, (problem.inner, problem.over), branch, flags, seed, turns, within, side
    return Locus(*about, limit=limit)


def _limit(problem: LocusProblem, start: Solved) -> str:
    """What the cycles of a long period stand for where their locus begins."""
    u, p = problem.split(start.u)
    found = limit_of(on_mesh(problem.at(start.p)), u, float(p))
    return "" if found is None else found.limit


def _put_at_end(problem: LocusProblem, branch: Branch, index: int, end: PlanePoint) -> None:
    """Let a locus end at the point of a shorter or more symmetric motion that is its end."""
    nothing = np.zeros(len(end.u) + 1)
    if isinstance(problem.base, Adaptive):
        u = on_mesh(problem.base).resting(problem.split(branch.points[index])[0], end.u)
    else:
        u = end.attached.offspring(end.attached.flip_kind, end.u, end.value[0], nothing, -1.0 + 0.0j)[0].u
    branch.points, branch.values = branch.points.copy(), branch.values.copy()
    branch.points[index] = problem.joined(np.asarray(u, dtype=float), end.value[0])
    branch.values[index] = end.value[1]


def _unfolds(problem: LocusProblem, points: np.ndarray) -> bool:
    return bool((np.abs(points[:, problem.size + 1]) > VANISHING.singular).any())


def _border(half: HalfBranch) -> Located | None:
    if half.status != Status.BORDER or not half.events:
        return None
    last = half.events[-1][1]
    return last if last.role is Role.BORDER else None


def _becoming(
    problem: LocusProblem, half: HalfBranch, within: tuple[float, float]
) -> tuple[str, PlanePoint | None]:
    """What the motion becomes where its equations become singular, a shorter one run twice, or a symmetric one, and the point of
    codimension two at which it does; empty where neither."""
    if half.status not in SINGULAR:
        return "", None
    points = [Solved(*half.at(i), *NOTHING) for i in range(len(half))]
    (u, p), q = problem.split(points[-1].u), points[-1].p
    if isinstance(problem.base, Adaptive):
        end, what = vanishing(problem, points, within), "an equilibrium"
        if end is None:
            return "", None
    else:
        met = becomes(problem, u, float(p), q)
        if met is None:
            return "", None
        what = "a shorter one, run twice" if met.kind == "period-doubling" else "symmetric"
        end = beginning(problem, points[-1], within)
    p, q, digits = (float(p), q, 7) if end is None else (*end.value, 10)
    return f"the motion becomes {what}, at {_place(problem, half, p, q, digits)}", end


def _sentence(problem: LocusProblem, half: HalfBranch) -> str:
    """Why this side of the locus ends."""
    border = _border(half)
    if half.events and half.events[-1][1].role is Role.MEETING:
        met, at = half.events[-1][1], half.events[-1][1].point
        what = "an equilibrium" if met.kind == "hopf" else "a cycle of half the period"
        return f"the cycle becomes {what}, at {_place(problem, half, float(problem.split(at.u)[1]), at.p)}"
    if border is None:
        return half.status.sentence(problem.over, half.end)
    kind, p, q = problem.margin_kind(border.index), float(problem.split(border.point.u)[1]), border.point.p
    if problem.condition == PERIOD and kind == "homoclinic":
        return (
            f"a period of {problem.reference:.6g} is too short at {_place(problem, half, p, q, 6)}: "
            "the cycle comes no nearer to an equilibrium than 3 % of its size; give a longer period="
        )
    place = _place(problem, half, p, q)
    if kind == "end":
        return f"reaches the end of the interval of {problem.inner}, {place}"
    if kind == "resonance":
        return f"the pair of multipliers becomes real at {place}"
    return f"reaches a border ({kind}) at {place}"


def _place(problem: LocusProblem, half: HalfBranch, p: float, q: float, digits: int = 10) -> str:
    """Both parameters; what is rounding beside their largest values along the locus is 0."""
    points = [half.at(i) for i in range(len(half))]
    largest = np.abs([(float(problem.split(u)[1]), value) for u, value, *_ in points]).max(axis=0)
    at = [number_text(value, digits, unit) for value, unit in zip((p, q), largest, strict=True)]
    return f"{problem.inner} = {at[0]}, {problem.over} = {at[1]}"
