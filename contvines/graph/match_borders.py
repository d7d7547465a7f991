"""Borders: match a border that is reached from both sides, with different words, and find the solutions beyond it."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from ..bifurcation.kinds import BORDERS
from ..bifurcation.locate import Located
from ..branches import Branch
from ..branches.special_point import SpecialPoint
from ..journal import NullJournal
from ..problems.abilities import Onward
from ..problems.protocol import Problem, Seed
from ..problems.registry import UnknownFactory, rebuild
from .identity import Place, is_end, may_be_one, same_value
from .run import Origin, Pending, Run

CROSSING = "the search for solutions beyond the border"
DEEPER = "the solutions found beyond are not followed: depth = {depth}"


def is_border(run: Run, problem: Problem, event: Located, label: str) -> bool:
    """Whether a border found on a branch of `problem` is the same as the known one with this label."""
    other, point = run.graph.special[label], event.point
    place, other_place = Place(point.p, event.error), Place(other.value, other.location_error)
    if not same_value(place, other_place, run.unit(point.p), run.settings.same):
        return False
    # results are stored: a branch that begins at a border is tested twice, before it is kept and when its end is labelled
    key = id(point.u), id(other)
    if key not in run.compared:
        run.compared[key] = (point, other, may_be_one(problem, point.u, point.p, other, run.settings.same))
    return run.compared[key][2]


def same_border(run: Run, label: str, branch: Branch) -> str:
    """Merge a border with that of the known branch beyond it, if both are the same point; return the label that remains."""
    graph = run.graph
    border = graph.special[label]
    engine = run.engine(branch.attached)
    for i, other in branch.marks:
        point = graph.special[other]
        if other == label or point.kind not in BORDERS or not _in_one_place(run, point, border):
            continue
        if may_be_one(border.attached, border.u, border.value, point, run.settings.same) or is_end(
            branch, engine, i, run.form(border)
        ):
            run.merge(label, other)
            return other
    return label


def _in_one_place(run: Run, one: SpecialPoint, other: SpecialPoint) -> bool:
    """Whether two special points have the same parameter value within their errors."""
    place, other_place = Place(one.value, one.location_error), Place(other.value, other.location_error)
    return same_value(place, other_place, run.unit(one.value), run.settings.same)


def tie_borders(run: Run) -> None:
    """Give one label to borders that were reached from two branches, and crossed from neither, and connect the branches."""
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
                continue  # the branch was reached through the other border: this is the far end of a very short branch
            if other.problem is not None and point.attached.same_motion(
                point.u, point.value, other.problem, other.u
            ):
                run.merge(label, other.label)
                run.connect(other.label, other.branch, point.branch)
                break


# ------------------------------------------------------------------ solutions beyond
def cross(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """Queue the solutions on the other side of a border; with ``virtual``, also the continuation of the branch itself.

    Parameters
    ----------
    run : Run
    point : SpecialPoint
        The border.
    branch : Branch
        The branch that ends there.
    depth : int
        Number of switches used for this branch.
    """
    leaving = point
    if point.index == 0:
        leaving = copy.copy(point)  # `dataclasses.replace` would compute the deferred fields
        leaving.tangent = -point.tangent
    outward, queued = leaving.tangent, list[Pending]()
    if branch.real:
        seeds = _seeds(run, leaving, depth < run.depth)
        for seed in seeds:
            # persistence uses no switch, a nonsmooth fold uses one
            deep = depth + (0 if seed.persistence else 1)
            if deep <= run.depth:
                u = np.asarray(seed.u, dtype=float)
                tangent = None if seed.tangent is None else np.asarray(seed.tangent, dtype=float)
                note = str(seed.note) or ("persistence" if seed.persistence else "nonsmooth fold")
                queued.append(
                    Pending(seed.problem, u, float(seed.p), tangent, Origin.BORDER, deep, note=note)
                )
        if not seeds:
            tell_dead_end(run, leaving)
        elif not queued:
            run.remark(point.label, DEEPER.format(depth=run.depth))
    if run.virtual:
        engine = run.engine(point.attached)
        border, z = engine.weights * outward, engine.join(point.u, point.value)
        origin = engine.polish(point.u, point.value, border, float(border @ z), outward)
        if origin is not None:
            origin = origin._replace(tangent=engine.unit(outward))  # the solved tangent may be rounding
        rest = Pending(point.attached, point.u, point.value, outward, Origin.REST, depth, origin=origin)
        rest.note, rest.real = "virtual" if branch.real else "real again", not branch.real
        queued.append(rest)
    for pending in queued:
        pending.source, pending.point = branch.label, point.label
    run.queue += queued


def tell_dead_end(run: Run, point: SpecialPoint) -> None:
    """Add the problem's explanation why no solution continues at a border as a remark."""
    run.remark(point.label, run.attempt(point.label, CROSSING, partial(point.attached.dead_end, point), ""))


def _seeds(run: Run, point: SpecialPoint, every: bool) -> list[Seed]:
    """Compute the solutions beyond a border, or recall them from the journal.

    Unless `every`, problems that can (`Onward`) first look for solutions that continue the branch, and for others only if there are none.
    """
    problem = point.attached
    onward = problem.onward if isinstance(problem, Onward) and not every else None
    key = f"{run.serial}/{'beyond' if onward is None else 'onward'}/{point.label}"
    recorded = run.journal.recall(key)
    rebuilt = _rebuilt(recorded)
    if rebuilt is not None:
        return rebuilt
    ask = onward or problem.beyond
    seeds = run.attempt(point.label, CROSSING, lambda: list(ask(point)), None)
    if seeds is None:
        return []
    if recorded is None and not isinstance(run.journal, NullJournal):
        run.journal.record(key, _recorded(seeds))
    return seeds


def _recorded(seeds: list[Seed]) -> dict[str, Any]:
    """Return seeds as a record of a journal."""
    record: dict[str, Any] = {
        "problems": [dict(seed.problem.describe()) for seed in seeds],
        "p": [float(seed.p) for seed in seeds],
        "note": [str(seed.note) for seed in seeds],
        "persistence": [bool(seed.persistence) for seed in seeds],
    }
    for i, seed in enumerate(seeds):
        record[f"u{i}"] = np.asarray(seed.u, dtype=float)
        if seed.tangent is not None:
            record[f"tangent{i}"] = np.asarray(seed.tangent, dtype=float)
    return record


def _rebuilt(record: Mapping[str, Any] | None) -> list[Seed] | None:
    """Rebuild seeds from a journal's record; None without a record, or if a problem cannot be rebuilt, so that they must be computed again."""
    if record is None:
        return None
    seeds = []
    for i, entry in enumerate(record["problems"]):
        try:
            problem = rebuild(entry)
        except UnknownFactory:
            return None
        if problem is None:
            return None
        tangent, note = record.get(f"tangent{i}"), record["note"][i]
        persistence = bool(record["persistence"][i])
        seeds.append(Seed(problem, record[f"u{i}"], record["p"][i], tangent, "border", note, persistence))
    return seeds
