"""Continuation of special points in the plane of two parameters, and the reasons why their loci end."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping
from typing import Any

import numpy as np

from ..bifurcation.detect import Detector
from ..bifurcation.kind import Kind
from ..bifurcation.kinds import BY_NAME, checked
from ..bifurcation.locate import Located, Role
from ..branches import Branch, Ending
from ..branches.half_branch import HalfBranch, Meshes, make_branch
from ..branches.special_point import SpecialPoint
from ..branches.tracing import trace_half
from ..continuation.engine import Engine, Solved
from ..continuation.layout import Status
from ..continuation.settings import Settings, hinting
from ..continuation.starts import check_interval
from ..journal import Journal, NullJournal
from ..long_work import listening
from ..problems.abilities import Adaptive
from ..problems.protocol import Problem
from ..problems.registry import without_problem
from ..shared.numbers import number_text
from .adaptive import on_mesh
from .codimension_two import beginning, simpler_motion, vanishing, without_rows
from .departures import homoclinic_of
from .kernels import BRANCH, MARGIN, PERIOD
from .locus import Locus, PlanePoint, Turn
from .plane import Place, impossible_side
from .problem import LocusProblem
from .settings import VANISHING
from .starts import Candidate, begin, candidate_of, check_start, first_point, limit_of, with_period

MOST = 20  # most borders that one side of a locus passes
#: statuses with which a side may end where the equations become singular
SINGULAR = (
    Status.STEP_TOO_SMALL,
    Status.NOT_EVALUABLE,
    Status.CREEPING,
    Status.BORDER,
    Status.COARSE,
)

Interval = tuple[float, float]
Progress = Callable[[str, int, float], None]


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
    """Continue a special point of any kind in a second parameter.

    Parameters
    ----------
    point : SpecialPoint or PlanePoint
        A fold, symmetry breaking, branch point, period doubling, Neimark-Sacker or Hopf point, any border, or a homoclinic end of a branch of
        cycles of a flow. From a Bogdanov-Takens point of a flow, which lies on another locus, the homoclinic orbits that begin there are continued.
    over : str
        Name of the second parameter.
    within : (float, float)
        Interval of the second parameter; it must contain the value at which the diagram was made.
    bounds : (float, float), optional
        Interval of the first parameter, at whose ends the locus ends; unbounded by default.
    virtual : bool
        Continue where the motion is not real (``real`` is False at such points).
    settings : Settings or mapping, optional
    progress : callable, optional
        Called with (label, number of points, value of the second parameter).
    period : float, optional
        For a homoclinic end: period of the cycles that represent the homoclinic orbits along the locus. By default the period at the end of
        the branch, for a heteroclinic cycle a shorter one, at a Bogdanov-Takens point that of the first orbit.
    kinds : iterable of Kind, optional
        As in :func:`contvines.diagram`: zeros of the tests of user-defined kinds along the locus are among its points, too. A special
        point of a user-defined kind from a file needs its kind here.

    Returns
    -------
    Locus

    Raises
    ------
    ValueError
        If the point has no locus, or a parameter or interval is unsuitable.
    """
    if point.kind in ("end", "user"):
        raise ValueError(f"{point.label} is no special point of the motion ({point.kind}); it has no locus")
    within = check_interval(within)
    limits = (-np.inf, np.inf) if bounds is None else check_interval(bounds)
    own_kinds = tuple(kind for kind in checked(kinds) if BY_NAME.get(kind.name) is not kind)
    if isinstance(point, PlanePoint):
        start = _homoclinic_near(point, over, within, limits)
    else:
        check_start(point, over, within)
        start = candidate_of(point, over, own_kinds, suited=period is None)
    if period is not None:
        if start.kind != "homoclinic":
            raise ValueError(
                f"period = {period!r}: {point.label} is no homoclinic end of a branch ({point.kind})"
            )
        try:
            start = with_period(start, period)
        except ValueError as error:
            raise ValueError(f"{point.label}: {error}") from error
    found = trace_locus(
        start, over, within, limits, Settings.of(settings), point.label, virtual, NullJournal(), progress
    )
    if found is None:
        raise ValueError(
            f"the locus of {point.label} cannot be started: its equations do not converge at {over} = {start.q:.10g}"
        )
    found.kinds = own_kinds
    return found


def _homoclinic_near(point: PlanePoint, over: str, within: Interval, bounds: Interval) -> Candidate:
    """The homoclinic orbit near a Bogdanov-Takens point of a flow, as a start."""
    if point.problem is None:
        raise ValueError(without_problem(point.label))
    if point.kind != "bogdanov-takens":
        raise ValueError(
            f"{point.label} is a point of codimension two ({point.kind}); only Bogdanov-Takens points of flows begin loci by themselves"
        )
    if over != point.parameters[1]:
        raise ValueError(f"over = {over!r}: {point.label} lies on a locus over {point.parameters[1]!r}")
    found = next(homoclinic_of(point, bounds, within), None)
    if found is None:
        raise ValueError(f"no homoclinic orbit is found beside {point.label}")
    return found


def trace_locus(
    start: Candidate,
    over: str,
    within: Interval,
    bounds: Interval,
    settings: Settings,
    label: str,
    virtual: bool,
    journal: Journal,
    progress: Progress | None,
) -> Locus | None:
    """Trace the locus through a special point in both directions; None if Newton's method fails at its first point.

    Parameters
    ----------
    start : Candidate
    over, within, bounds, settings, virtual, progress
        As for :func:`locus`.
    label : str
        Label of the locus.
    journal : Journal
        Recorded points are not computed again.
    """
    problem = begin(start, over, bounds)
    engine, first = first_point(problem, start.u, start.p, start.q, within, settings)
    if first is None:
        return None
    real = not np.any(engine.margins(first.row)[: int(problem.base.n_margins)] < -VANISHING.margin)
    if first.tangent[-1] < 0.0:
        first = first._replace(tangent=-first.tangent, sign=-first.sign)

    def notice(points: int, value: float) -> None:
        if progress is not None:
            progress(label, points, value)

    sides = BothSides(engine, f"locus/{label}", journal, notice, real, virtual)
    found = sides.followed(first)
    whole = back = ahead = found["ahead"]
    closed, flags = ahead.status == Status.CLOSED, sides.real["ahead"]
    if not closed:
        back = found["back"]
        whole = back.reversed().extended(ahead, skip=1)
        flags = np.append(sides.real["back"][::-1], flags[1:])
    problem = locus_of(whole)
    ends = [becoming(half, within) for half in (back, ahead)]
    first_end, last_end = (
        Ending.from_text(became or sentence(half)) for (became, _), half in zip(ends, (back, ahead))
    )
    branch = make_branch(label, whole, real, (first_end, last_end), closed, start.seed)
    branch.description["unfolded"] = problem.condition == BRANCH
    for index, (_, point) in zip((0, -1), ends):
        if point is not None:
            _put_at_end(problem, branch, index, point)
    if (
        problem.condition == BRANCH
        and (np.abs(branch.points[:, problem.size + 1]) > VANISHING.singular).any()
    ):
        return None  # the unfolding is not zero: the branch point does not persist
    turns = tuple(
        Turn(i, (float(problem.split(e.point.u)[1]), float(e.point.p)))
        for i, e in whole.events
        if e.kind == "fold"
    )
    limit = ""
    if problem.condition == PERIOD:  # determine the limit of infinite period at the start of the locus
        u, q, _ = ahead.at(0)
        inner, p = problem.split(u)
        at = limit_of(on_mesh(problem.at(q)), inner, float(p))
        limit = "" if at is None else at.limit
    return Locus(
        label,
        problem.kind,
        (problem.inner, over),
        branch,
        flags,
        start.seed,
        turns,
        within,
        beyond=impossible_side(problem, branch) if problem.condition == MARGIN else 0,
        limit=limit,
    )


def _put_at_end(problem: LocusProblem, branch: Branch, index: int, end: PlanePoint) -> None:
    """Replace the last point of a locus by the point of codimension two of a shorter or more symmetric motion at which it ends; in place."""
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


class BothSides:
    """Traces the two sides of a locus, "ahead" and "back", on a common mesh; a closed locus has only the side "ahead".

    Parameters
    ----------
    engine : Engine
        Engine of the locus on its first mesh.
    name : str
        Key of the journal's records.
    journal : Journal
    notice : callable
        See :func:`contvines.branches.tracing.trace_half`.
    real : bool
        Whether the motion is real at the first point.
    virtual : bool
        Continue where the motion is not real.

    Attributes
    ----------
    real : dict of ndarray of bool
        For each side, whether the motion is real at its points.
    """

    def __init__(
        self,
        engine: Engine,
        name: str,
        journal: Journal,
        notice: Callable[[int, float], None],
        real: bool,
        virtual: bool,
    ) -> None:
        self.engine, self.name, self.journal, self.notice = engine, name, journal, notice
        self.begins_real, self.virtual = real, virtual
        self.meshes = Meshes(Detector(engine), self._detector_of, self._vanishes)
        self.real: dict[str, np.ndarray] = {}

    def followed(self, start: Solved) -> dict[str, HalfBranch]:
        """Trace both sides from a point, in the direction of its tangent and backwards, on one mesh."""
        return self.meshes.followed(start, self._halves, self.meshes.moved, self.begins_real)[0]

    def _detector_of(self, problem: Problem) -> Detector:
        return Detector(Engine(problem, self.engine.within, self.engine.settings))

    def _vanishes(self, half: HalfBranch) -> bool:
        return becoming(half, self.engine.within)[1] is not None

    def _halves(self, detector: Detector, start: Solved, done: Container[str]) -> dict[str, HalfBranch]:
        turned = start._replace(tangent=-start.tangent, sign=-start.sign)
        found: dict[str, HalfBranch] = {}
        for side, first in (("ahead", start), ("back", turned)):
            if side not in done:
                found[side] = self._side(detector, first, side)
                if found[side].status == Status.CLOSED:
                    break
        return found

    def _side(self, detector: Detector, first: Solved, side: str) -> HalfBranch:
        mesh = self.meshes.detectors.index(detector)
        name = f"{self.name}/finer {mesh}/{side}" if mesh else f"{self.name}/{side}"
        real, half, self.real[side] = self.begins_real, None, np.zeros(0, dtype=bool)
        for part in range(MOST):
            more = trace_half(
                detector, first, self.journal, f"{name}/{part}", real, notice=self.notice, meshes=self.meshes
            )
            new = len(more) - (0 if half is None else 1)
            self.real[side] = np.append(self.real[side], np.full(new, real))
            half = more if half is None else self.meshes.read(half, more.detector).extended(more, skip=1)
            border = border_of(more)
            if border is None or not self.virtual:
                break
            if locus_of(more).margin_kind(border.index) in ("end", "resonance"):
                break
            detector, real, first = more.detector, not real, border.point
        assert half is not None
        return half


# ------------------------------------------------------------------ ends of a side
def locus_of(half: HalfBranch) -> LocusProblem:
    """Return the problem of a side, on its current mesh."""
    problem = half.engine.problem
    assert isinstance(problem, LocusProblem)
    return problem


def border_of(half: HalfBranch) -> Located | None:
    """Return the border at which a side ends; None if it ends otherwise."""
    last = half.events[-1][1] if half.events and half.status == Status.BORDER else None
    return last if last is not None and last.role is Role.BORDER else None


def becoming(half: HalfBranch, within: Interval) -> tuple[str, PlanePoint | None]:
    """Return a sentence and the point of codimension two if a side ends because its motion becomes an equilibrium, a shorter motion run twice, or a
    symmetric motion; else an empty sentence and None."""
    if half.status not in SINGULAR:
        return "", None
    problem = locus_of(half)
    points = without_rows(*half.joined()[:3])
    (u, p), q = problem.split(points[-1].u), points[-1].p
    if isinstance(problem.base, Adaptive):
        end, name = vanishing(problem, points, within), "an equilibrium"
        if end is None:
            return "", None
    else:
        simpler = simpler_motion(problem, Place(u, float(p), q))
        if simpler is None:
            return "", None
        name = "a shorter one, run twice" if simpler.kind == "period-doubling" else "symmetric"
        end = beginning(problem, points[-1], within)
    p, q, digits = (float(p), q, 7) if end is None else (*end.value, 10)
    return f"the motion becomes {name}, at {_place(half, p, q, digits)}", end


def sentence(half: HalfBranch) -> str:
    """Return the sentence why a side of a locus ends, if its motion does not become another one."""
    problem = locus_of(half)
    border = border_of(half)
    if half.events and half.events[-1][1].role is Role.MEETING:
        event, at = half.events[-1][1], half.events[-1][1].point
        name = "an equilibrium" if event.kind == "hopf" else "a cycle of half the period"
        return f"the cycle becomes {name}, at {_place(half, float(problem.split(at.u)[1]), at.p)}"
    if border is None:
        return half.status.sentence(problem.over, half.end)
    kind, p, q = problem.margin_kind(border.index), float(problem.split(border.point.u)[1]), border.point.p
    if problem.condition == PERIOD and kind == "homoclinic":
        return (
            f"a period of {problem.reference:.6g} is too short at {_place(half, p, q, 6)}: "
            "the cycle comes no nearer to an equilibrium than 3 % of its size; give a longer period="
        )
    place = _place(half, p, q)
    if kind == "end":
        return f"reaches the end of the interval of {problem.inner}, {place}"
    if kind == "resonance":
        return f"the pair of multipliers becomes real at {place}"
    return f"reaches a border ({kind}) at {place}"


def _place(half: HalfBranch, p: float, q: float, digits: int = 10) -> str:
    """Text of both parameters; values at the level of rounding, compared with their largest values along the locus, are 0."""
    problem, whole = locus_of(half), half.joined()
    largest = np.abs([problem.split(whole.points)[1], whole.values]).max(axis=1)
    at = [number_text(value, digits, unit) for value, unit in zip((p, q), largest, strict=True)]
    return f"{problem.inner} = {at[0]}, {problem.over} = {at[1]}"
