"""Merge two graphs of one problem: branches and special points in both are kept once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..continuation.settings import Settings
from ..graph import Graph
from ..graph.identity import same_form
from ..graph.run import Run
from .census import run_on

if TYPE_CHECKING:
    from ..branches import Branch
    from ..branches.special_point import SpecialPoint


def merge(graph: Graph, other: Graph) -> dict[str, str]:
    """Add to a graph the branches, special points, switches and attractors of another one that it lacks; the first graph is changed in place.

    Parameters
    ----------
    graph, other : Graph
        Of the same machine and the same parameter, with their problems attached.

    Returns
    -------
    dict
        Label in `graph` of each branch and special point of `other`, by its label there.

    Raises
    ------
    ValueError
        If parameters or machines differ, or a branch has no problem.
    """
    _refuse_strangers(graph, other)
    run = run_on(graph)
    called: dict[str, str] = {}
    added: list[Branch] = []
    for branch in other.branches.values():
        middle = len(branch) // 2
        match = run.register.find(
            branch.attached, branch.points[middle], float(branch.values[middle]), branch.real
        )
        called[branch.label] = run.new_label("B") if match is None else match.label
        if match is None:
            added.append(replace(branch, label=called[branch.label]))
            graph.branches[added[-1].label] = added[-1]
            run.register.add(added[-1], run.engine(branch.attached))
    for point in other.special.values():
        called[point.label] = _special(run, point, called)
    names = {**called, None: None}
    for branch in added:
        branch.marks = tuple((i, called[mark]) for i, mark in branch.marks)
        branch.seed = names[branch.seed]
        first, last = (
            replace(ending, point=names[ending.point], other=names[ending.other]) for ending in branch.endings
        )
        branch.endings = first, last
    for switch in other.switches:
        run.connect(called[switch.point], called[switch.source], called[switch.target], switch.note)
    attractors = [replace(a, branch=None if a.branch is None else called[a.branch]) for a in other.attractors]
    graph.attractors = sorted([*graph.attractors, *attractors], key=lambda a: a.value)
    graph.within = (min(graph.within[0], other.within[0]), max(graph.within[1], other.within[1]))
    return called


def _special(run: Run, point: SpecialPoint, called: dict[str, str]) -> str:
    """Return the label in the run's graph of an equal special point; if there is none, add the point under a new label."""
    graph = run.graph
    form = point.attached.canonical(point.u, point.value)
    for candidate in graph.special.values():
        near = abs(candidate.value - point.value) <= run.settings.same * run.unit(point.value)
        comparable = candidate.kind == point.kind and near and candidate.problem is not None
        if comparable and same_form(run.form(candidate), form):
            return candidate.label
    label = run.new_label(point.label.rstrip("0123456789"))
    graph.special[label] = replace(point, label=label, branch=called[point.branch])
    return label


def _refuse_strangers(graph: Graph, other: Graph) -> None:
    if graph.parameter != other.parameter:
        raise ValueError(f"graphs over {graph.parameter} and over {other.parameter} cannot be merged")
    for name, value in graph.model.items():
        other_value = other.model.get(name, value)
        numbers = isinstance(value, int | float) and isinstance(other_value, int | float)
        if (numbers and not np.isclose(value, other_value, rtol=Settings.rounding)) or (
            not numbers and other_value != value
        ):
            raise ValueError(
                f"graphs of two machines cannot be merged: {name} = {value} here and {other_value} there"
            )
    for part in (graph, other):
        lost = [b.label for b in part.branches.values() if b.problem is None]
        if lost:
            raise ValueError(f"{lost[0]} has no problem attached; use graph.attach(problem) before merging")
