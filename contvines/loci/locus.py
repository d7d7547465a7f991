"""Locus: the special points of one kind in the plane of two parameters, and how it is traced."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..branches.assembly import make_branch
from ..branches.branch import Branch
from ..branches.ending import Ending
from ..branches.half_branch import HalfBranch
from ..branches.special_point import SpecialPoint
from ..branches.tracing import trace_half
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..continuation.starts import check_interval
from ..continuation.status import Status
from ..events.located import Located, Role
from ..events.watch import Watch
from ..journal import NullJournal
from .kernels import BRANCH, MARGIN
from .problem import LocusProblem
from .sides import impossible_side
from .starts import begin, first_point

UNFOLDED = 1e-7  # an unfolding beyond this (relative to the largest unknown) says that a branch point does not persist


class Turn(NamedTuple):
    """A point at which the locus turns round in the second parameter."""

    index: int
    value: tuple[float, float]


@dataclass(eq=False)
class Locus:
    """The special points of one kind that hang together, in the plane of two parameters.

    Attributes
    ----------
    label : str
    kind : str
        Of the special points.
    parameters : (str, str)
        The parameter of the diagram and the second one.
    branch : Branch
        The locus as a branch against the second parameter: ``points`` are (u, p), ``values`` those of the second parameter.
    real : ndarray of bool, shape (n,)
        False beyond a border, where no machine follows the motion.
    seed : str or None
        Label of the special point from which it was started.
    marks : tuple of (int, str)
        Index and label of the points of codimension two on it.
    turns : tuple of Turn
        Where it turns round in the second parameter.
    within : (float, float)
        Interval of the second parameter.
    beyond : int
        Of a border: on which side of it, looking along the points with q to the right and p upwards, the motion cannot be: 1
        left, -1 right, 0 not known.
    """

    label: str
    kind: str
    parameters: tuple[str, str]
    branch: Branch = field(repr=False)
    real: np.ndarray = field(repr=False)
    seed: str | None = None
    marks: tuple[tuple[int, str], ...] = ()
    turns: tuple[Turn, ...] = ()
    within: tuple[float, float] = (-np.inf, np.inf)
    beyond: int = 0

    def __len__(self) -> int:
        return len(self.branch)

    def __repr__(self) -> str:
        p, q = self.parameters
        lo, hi = self.branch.range
        return f"Locus({self.label}: {self.kind}, {len(self)} points, {q} in [{lo:.6g}, {hi:.6g}])"

    @property
    def problem(self) -> Any:
        """The LocusProblem, or None after loading without the problem."""
        return self.branch.problem

    @property
    def size(self) -> int:
        """Number of unknowns of the motion itself."""
        extra = 2 if self.branch.description.get("unfolded") else 1
        return self.branch.points.shape[1] - extra

    @property
    def values(self) -> np.ndarray:
        """(p, q) of the points, shape (n, 2)."""
        return np.column_stack([self.branch.points[:, self.size], self.branch.values])

    @property
    def ended(self) -> tuple[str, str]:
        """Why the locus ends, at its first and at its last point."""
        return self.branch.ended

    @property
    def closed(self) -> bool:
        """Whether the last point is the first one again."""
        return self.branch.closed

    def orbit(self, i: int) -> Any:
        """The special solution at point i as the object that the problem hands to users."""
        return self.branch.orbit(i)

    def at(self, value: float) -> np.ndarray:
        """Values of the first parameter where the second one has a value, solved to roundoff; shape (k,)."""
        q, found = self.branch.values, []
        if self.problem is None:
            raise ValueError(f"{self.label} was loaded without its problem; nothing can be solved on it")
        engine = Engine(self.problem, _around(q, value), Settings())
        for i in np.flatnonzero((q[:-1] - value) * (q[1:] - value) <= 0.0):
            share = 0.0 if q[i + 1] == q[i] else (value - q[i]) / (q[i + 1] - q[i])
            guess = (1.0 - share) * self.branch.points[i] + share * self.branch.points[i + 1]
            point = engine.at_value(guess, value)
            if point is not None:
                found.append(float(point.u[self.size]))
        kept: list[float] = []
        for p in sorted(found):
            if not kept or p - kept[-1] > 1e-10 * (1.0 + abs(p)):
                kept.append(p)
        return np.array(kept)

    def to_dict(self) -> dict[str, Any]:
        """The entry of this locus in the JSON of a chart."""
        about = self.branch.description
        return {
            "label": self.label,
            "kind": self.kind,
            "word": about.get("word"),
            "periods": about.get("periods"),
            "seed": self.seed,
            "values": self.values.tolist(),
            "real": [bool(r) for r in self.real],
            "ended": list(self.ended),
            "closed": bool(self.closed),
            "points": [label for _, label in self.marks],
        }


def _around(q: np.ndarray, value: float) -> tuple[float, float]:
    low, high = min(float(q.min()), value), max(float(q.max()), value)
    wide = max(high - low, 1e-12 * (1.0 + abs(high)))
    return low - 1e-9 * wide, high + 1e-9 * wide


def locus(
    point: SpecialPoint,
    over: str,
    within: tuple[float, float],
    bounds: tuple[float, float] | None = None,
    virtual: bool = False,
    settings: Settings | Mapping[str, Any] | None = None,
    progress: Callable[[str, int, float], None] | None = None,
) -> Locus:
    """Follow a special point of any kind in a second parameter.

    Parameters
    ----------
    point : SpecialPoint
        Fold, symmetry breaking, branch point, period doubling, Neimark-Sacker, Hopf, or any border.
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
        raise ValueError(f"{point.label} has no problem attached; use graph.attach(problem) first")
    within = check_interval(within)
    known = getattr(point.problem, "parameters", {})
    problem = begin(
        point.problem,
        point.kind,
        point.u,
        point.value,
        over,
        point.margin_index or 0,
        (-np.inf, np.inf) if bounds is None else check_interval(bounds),
    )
    q = known[over]
    if not within[0] <= q <= within[1]:
        raise ValueError(
            f"the diagram was made at {over} = {q:.10g}, outside of within = [{within[0]:.10g}, {within[1]:.10g}]; "
            "widen the interval"
        )
    checked_ends(point.problem, over, within)
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
    return found


def checked_ends(problem: Any, over: str, within: tuple[float, float]) -> None:
    """Refuse an interval whose ends are no sensible values of the parameter, where the problem can tell."""
    check = getattr(problem, "check_value", None)
    if check is not None:
        for value in within:
            check(over, value)


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
    journal: Any = None,
    progress: Callable[[str, int, float], None] | None = None,
) -> Locus | None:
    """The locus through a special point, both ways; None if its equations do not converge there."""
    engine, start = first_point(problem, u, p, q, within, settings)
    if start is None:
        return None
    watch = Watch(engine)
    journal = NullJournal() if journal is None else journal
    own = int(problem.base.n_margins)
    margins = engine.margins(start.row)
    real = not np.any(margins[:own] < -1e-9)

    def notice(points: int, value: float) -> None:
        if progress is not None:
            progress(label, points, value)

    def go(first: Solved, side: str) -> tuple[HalfBranch, np.ndarray, str]:
        now, half = real, None
        flags = np.zeros(0, dtype=bool)
        for part in range(20):
            more = trace_half(
                engine, first, watch, journal, f"locus/{label}/{side}/{part}", now, None, notice
            )
            flags = np.append(flags, np.full(len(more) - (0 if half is None else 1), now))
            half = more if half is None else half.extended(more, skip=1)
            border = _border(more)
            if border is None or not virtual or problem.margin_kind(border.index) in ("end", "resonance"):
                break
            now, first = not now, border.point
        assert half is not None
        return half, flags, _sentence(problem, half)

    if start.tangent[-1] < 0.0:
        start = start._replace(tangent=-start.tangent, sign=-start.sign)
    ahead, ahead_real, ahead_ended = go(start, "ahead")
    if ahead.status == Status.CLOSED:
        whole, flags, ended = ahead, ahead_real, (ahead_ended, ahead_ended)
    else:
        back, back_real, back_ended = go(start._replace(tangent=-start.tangent, sign=-start.sign), "back")
        whole = back.reversed().extended(ahead, skip=1)
        flags = np.append(back_real[::-1], ahead_real[1:])
        ended = (back_ended, ahead_ended)
    endings = (Ending.said(ended[0]), Ending.said(ended[1]))
    branch = make_branch(label, engine, whole, real, endings, ahead.status == Status.CLOSED, seed)
    branch.description["unfolded"] = problem.unfolded
    if problem.condition == BRANCH and _unfolds(problem, branch.points):
        return None
    turns = tuple(
        Turn(i, (float(e.point.u[problem.size]), float(e.point.p)))
        for i, e in whole.events
        if e.kind == "fold"
    )
    side = impossible_side(problem, branch) if problem.condition == MARGIN else 0
    return Locus(
        label, problem.kind, (problem.inner, problem.over), branch, flags, seed, (), turns, within, side
    )


def _unfolds(problem: LocusProblem, points: np.ndarray) -> bool:
    sizes = 1.0 + np.abs(points[:, : problem.size]).max(axis=1)
    return bool((np.abs(points[:, problem.size + 1]) > UNFOLDED * sizes).any())


def _border(half: HalfBranch) -> Located | None:
    if half.status != Status.BORDER or not half.events:
        return None
    last = half.events[-1][1]
    return last if last.role is Role.BORDER else None


def _sentence(problem: LocusProblem, half: HalfBranch) -> str:
    """Why this side of the locus ends."""
    border = _border(half)
    if border is None:
        return half.status.sentence(problem.over, half.end)
    kind, p, q = problem.margin_kind(border.index), border.point.u[problem.size], border.point.p
    place = f"{problem.inner} = {p:.10g}, {problem.over} = {q:.10g}"
    if kind == "end":
        return f"reaches the end of the interval of {problem.inner}, {place}"
    if kind == "resonance":
        return f"the pair of multipliers becomes real at {place}"
    return f"reaches a border ({kind}) at {place}"


__all__ = ["MARGIN", "Locus", "Turn", "checked_ends", "locus", "trace_locus"]
