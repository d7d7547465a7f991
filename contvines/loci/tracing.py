"""How the special points of one kind are followed in the plane of two parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME, checked
from ..branches.assembly import make_branch
from ..branches.branch import Branch
from ..branches.ending import Ending
from ..branches.half_branch import HalfBranch
from ..branches.special_point import SpecialPoint
from ..continuation.layout import Status
from ..continuation.settings import Settings, hinting
from ..continuation.starts import check_interval
from ..interrupts import listening
from ..journal import NullJournal
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..problems.registry import without_problem
from .both_sides import BothSides
from .ends import becoming, locus_of, sentence
from .homoclinic import homoclinic_of
from .layout import BRANCH, MARGIN, PERIOD
from .locus import Locus, Turn
from .long_period import lengthened, limit_of, with_suited_period
from .on_mesh import on_mesh
from .own_test import condition_of, of_own_kind
from .plane_point import PlanePoint
from .problem import LocusProblem
from .settings import VANISHING
from .sides import impossible_side
from .starts import begin, first_point, regular_side

if TYPE_CHECKING:
    from ..journal import Journal


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
        As in :func:`contvines.diagram`: zeros of the tests of kinds of your own along the locus are among its points, too. A special
        point of such a kind from a file needs it again.

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
    problem = begin(
        motion,
        point.kind,
        point.u,
        point.value,
        over,
        point.margin_index or 0,
        (-np.inf, np.inf) if bounds is None else check_interval(bounds),
        condition_of(point, own_kinds) if own else None,
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
) -> Locus | None:
    """The locus through a special point, both ways; None if its equations do not converge there."""
    engine, start = first_point(problem, u, p, q, within, settings)
    if start is None:
        return None
    journal = NullJournal() if journal is None else journal
    margins = engine.margins(start.row)
    real = not np.any(margins[: int(problem.base.n_margins)] < -VANISHING.margin)
    if start.tangent[-1] < 0.0:
        start = start._replace(tangent=-start.tangent, sign=-start.sign)

    def notice(points: int, value: float) -> None:
        if progress is not None:
            progress(label, points, value)

    sides = BothSides(engine, within, settings, f"locus/{label}", journal, notice, real, virtual)
    found = sides.followed(start)
    whole = ahead = found["ahead"]
    back = ahead if ahead.status == Status.CLOSED else found["back"]
    flags = sides.real["ahead"]
    if back is not ahead:
        whole = back.reversed().extended(ahead, skip=1)
        flags = np.append(sides.real["back"][::-1], flags[1:])
    problem = locus_of(whole)
    first, last = (_end(half, within) for half in (back, ahead))
    endings = (first[0], last[0])
    branch = make_branch(label, whole, real, endings, ahead.status == Status.CLOSED, seed)
    branch.description["unfolded"] = problem.unfolded
    for index, (_, end) in ((0, first), (-1, last)):
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
    limit = _limit(problem, *ahead.at(0)[:2]) if problem.condition == PERIOD else ""
    about = label, problem.kind, (problem.inner, problem.over), branch, flags, seed, turns, within, side
    return Locus(*about, limit=limit)


def _end(half: HalfBranch, within: tuple[float, float]) -> tuple[Ending, PlanePoint | None]:
    became, point = becoming(half, within)
    return Ending.said(became or sentence(half)), point


def _limit(problem: LocusProblem, u: np.ndarray, q: float) -> str:
    """What the cycles of a long period stand for where their locus begins."""
    inner, p = problem.split(u)
    found = limit_of(on_mesh(problem.at(q)), inner, float(p))
    return "" if found is None else found.limit


def _put_at_end(problem: LocusProblem, branch: Branch, index: int, end: PlanePoint) -> None:
    """Let a locus end at the point of a shorter or more symmetric motion that is its end, or of one that is both."""
    if isinstance(problem.base, Adaptive):
        u = on_mesh(problem.base).resting(problem.split(branch.points[index])[0], end.u)
    else:
        motion, u = end.attached, end.u
        while motion.dimension < problem.base.dimension:
            nothing = np.zeros(len(u) + 1)
            motion, u, *_ = motion.offspring(motion.flip_kind, u, end.value[0], nothing, -1.0 + 0.0j)[0]
    branch.points, branch.values = branch.points.copy(), branch.values.copy()
    branch.points[index] = problem.joined(np.asarray(u, dtype=float), end.value[0])
    branch.values[index] = end.value[1]


def _unfolds(problem: LocusProblem, points: np.ndarray) -> bool:
    return bool((np.abs(points[:, problem.size + 1]) > VANISHING.singular).any())
