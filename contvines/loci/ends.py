"""How a side of a locus ends: the motion becomes another one, or a sentence says why."""

from __future__ import annotations

import numpy as np

from ..bifurcation.located import Located, Role
from ..branches.half_branch import HalfBranch
from ..continuation.engine import Solved
from ..continuation.layout import Status
from ..problems.abilities import Adaptive
from ..shared.number_text import number_text
from .codimension_two import becomes, beginning, vanishing
from .layout import PERIOD
from .plane_point import PlanePoint
from .problem import LocusProblem

NOTHING = np.zeros(0), 0.0, 0.0, 0.0  # of a point of which no more is known
#: how a half may end where equations become singular
SINGULAR = (
    Status.STEP_TOO_SMALL,
    Status.NOT_EVALUABLE,
    Status.CREEPING,
    Status.BORDER,
    Status.COARSE,
)


def locus_of(half: HalfBranch) -> LocusProblem:
    """The problem of a side, on the mesh on which it is."""
    problem = half.engine.problem
    assert isinstance(problem, LocusProblem)
    return problem


def border_of(half: HalfBranch) -> Located | None:
    """The border at which a side ends, if it ends at one."""
    if half.status != Status.BORDER or not half.events:
        return None
    last = half.events[-1][1]
    return last if last.role is Role.BORDER else None


def becoming(half: HalfBranch, within: tuple[float, float]) -> tuple[str, PlanePoint | None]:
    """What the motion becomes where its equations become singular, a shorter one run twice, or a symmetric one, and the point of
    codimension two at which it does; empty where neither."""
    if half.status not in SINGULAR:
        return "", None
    problem = locus_of(half)
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
    return f"the motion becomes {what}, at {_place(half, p, q, digits)}", end


def sentence(half: HalfBranch) -> str:
    """Why a side of a locus ends, where the motion becomes no other one."""
    problem = locus_of(half)
    border = border_of(half)
    if half.events and half.events[-1][1].role is Role.MEETING:
        met, at = half.events[-1][1], half.events[-1][1].point
        what = "an equilibrium" if met.kind == "hopf" else "a cycle of half the period"
        return f"the cycle becomes {what}, at {_place(half, float(problem.split(at.u)[1]), at.p)}"
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
    """Both parameters; what is rounding beside their largest values along the locus is 0."""
    problem = locus_of(half)
    points = [half.at(i) for i in range(len(half))]
    largest = np.abs([(float(problem.split(u)[1]), value) for u, value, *_ in points]).max(axis=0)
    at = [number_text(value, digits, unit) for value, unit in zip((p, q), largest, strict=True)]
    return f"{problem.inner} = {at[0]}, {problem.over} = {at[1]}"
