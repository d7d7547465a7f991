"""Which borders are one: a border is seen from both its sides, with different words, and other borders may be very near."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..bifurcation.kinds import BORDERS
from ..bifurcation.located import Located
from ..branches.branch import Branch
from ..branches.special_point import SpecialPoint
from ..problems.protocol import Problem
from .identity import is_end, same_vector
from .run import Run

BACK_AT_BORDER = (
    1e-6  # a branch seeded beyond a border comes back to it within this part of the parameter's unit
)
PLACED, ERRORS = 1e-10, 10.0  # part of the unit, and times their errors, by which values of one border differ
AT_BORDER = 1e-4  # border points of one value further apart than this are two
ONE_VALUE = 1e-9  # parameter values of one border, at most (in the parameter's unit)


class Place(NamedTuple):
    """A parameter value, and how well it is known (0: not said)."""

    value: float
    error: float


def is_border(run: Run, problem: Problem, event: Located, label: str) -> bool:
    """Whether a branch has come to a border that is known by this label."""
    known, point = run.graph.special[label], event.point
    here, there = Place(point.p, event.error), Place(known.value, known.location_error)
    if not in_one_place(here, there, run.unit(point.p), BACK_AT_BORDER):
        return False
    # of a branch that begins at a border it is asked twice: whether to keep it, and how to mark its end
    key = id(point.u), id(known)
    if key not in run.compared:
        run.compared[key] = (point, known, may_be_one(problem, point.u, point.p, known))
    return run.compared[key][2]


def in_one_place(one: Place, other: Place, unit: float, loosely: float) -> bool:
    """Whether two borders may be one by their parameter values, as far as these are known.

    Parameters
    ----------
    one, other : Place
    unit : float
        Of the parameter.
    loosely : float
        Part of the unit that counts where one of the errors is not known. (It is told as zero where a branch begins with a margin
        that is rounding already.)
    """
    known = one.error > 0.0 and other.error > 0.0
    reach = PLACED * unit + ERRORS * (one.error + other.error) if known else loosely * unit
    return abs(one.value - other.value) <= min(reach, loosely * unit)


def may_be_one(problem: Problem, u: np.ndarray, p: float, point: SpecialPoint) -> bool:
    """Whether a solution may be a border point seen with another word: different motions do meet borders at one value.

    Only problems of one kind tell: those that can compare motions, and others where their forms have as many entries.
    """
    if type(point.problem) is not type(problem):
        return True
    alike = problem.same_motion(u, p, point.problem, point.u)
    if alike is not None:
        return alike
    one, other = problem.canonical(u, p)[1], point.problem.canonical(point.u, point.value)[1]
    scales = problem.scales
    return one.shape != other.shape or same_vector(
        one, other, AT_BORDER, None if scales is None else scales.vector
    )


def same_border(run: Run, label: str, known: Branch) -> str:
    """The border has led to a branch that ends at a border with this very value: they are one point, with one label."""
    graph = run.graph
    here = graph.special[label]
    engine, _ = run.engine(known.problem)
    for i, other in known.marks:
        point = graph.special[other]
        if other == label or point.kind not in BORDERS or not _in_one_place(run, point, here):
            continue
        if may_be_one(here.problem, here.u, here.value, point) or is_end(known, engine, i, *run.form(here)):
            run.merge(label, other)
            return other
    return label


def _in_one_place(run: Run, one: SpecialPoint, other: SpecialPoint) -> bool:
    unit = run.unit(one.value)
    if abs(one.value - other.value) > ONE_VALUE * unit:
        return False
    here, there = Place(one.value, one.location_error), Place(other.value, other.location_error)
    return in_one_place(here, there, unit, ONE_VALUE)


def tie_borders(run: Run) -> None:
    """One border that was reached from two branches, and crossed from neither, gets one label; the branches are tied."""
    graph = run.graph
    for label in list(graph.special):
        point = graph.special.get(label)
        if point is None or point.kind not in BORDERS or not point.real:
            continue
        for other in list(graph.special.values()):
            if other is point:
                break  # only those with an earlier label
            near = other.kind in BORDERS and other.real and other.branch != point.branch
            if not (near and _in_one_place(run, point, other)):
                continue
            if any(s.point == other.label and point.branch in (s.source, s.target) for s in graph.switches):
                continue  # its branch was reached through the other one: this is the far end of a very short branch
            if other.problem is not None and point.problem.same_motion(
                point.u, point.value, other.problem, other.u
            ):
                run.merge(label, other.label)
                run.connect(other.label, other.branch, point.branch)
                break
