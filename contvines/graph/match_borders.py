"""Which borders are one: a border is seen from both its sides, with different words, and other borders may be very near."""

from __future__ import annotations

from ..bifurcation.kinds import BORDERS
from ..bifurcation.located import Located
from ..branches.branch import Branch
from ..branches.special_point import SpecialPoint
from ..problems.protocol import Problem
from .identity import Place, is_end, may_be_one, same_value
from .run import Run


def is_border(run: Run, problem: Problem, event: Located, label: str) -> bool:
    """Whether a branch has come to a border that is known by this label."""
    known, point = run.graph.special[label], event.point
    here, there = Place(point.p, event.error), Place(known.value, known.location_error)
    if not same_value(here, there, run.unit(point.p), run.settings.same):
        return False
    # of a branch that begins at a border it is asked twice: whether to keep it, and how to mark its end
    key = id(point.u), id(known)
    if key not in run.compared:
        run.compared[key] = (point, known, may_be_one(problem, point.u, point.p, known, run.settings.same))
    return run.compared[key][2]


def same_border(run: Run, label: str, known: Branch) -> str:
    """The border has led to a branch that ends at a border with this very value: they are one point, with one label."""
    graph = run.graph
    here = graph.special[label]
    engine, _ = run.engine(known.attached)
    for i, other in known.marks:
        point = graph.special[other]
        if other == label or point.kind not in BORDERS or not _in_one_place(run, point, here):
            continue
        if may_be_one(here.attached, here.u, here.value, point, run.settings.same) or is_end(
            known, engine, i, *run.form(here)
        ):
            run.merge(label, other)
            return other
    return label


def _in_one_place(run: Run, one: SpecialPoint, other: SpecialPoint) -> bool:
    here, there = Place(one.value, one.location_error), Place(other.value, other.location_error)
    return same_value(here, there, run.unit(one.value), run.settings.same)


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
            if other.problem is not None and point.attached.same_motion(
                point.u, point.value, other.problem, other.u
            ):
                run.merge(label, other.label)
                run.connect(other.label, other.branch, point.branch)
                break
