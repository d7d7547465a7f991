"""A sweep's picture from its rows: which graph may lie beneath, and which dots its lines stand for."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.command.frame import load_file
from contvines.command.study_data import Sort, Study
from contvines.continuation.settings import Settings
from contvines.shared.floating_point import TINY
from orbits.flows.catalogue import flow_of
from orbits.words import Word

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..graph.graph import Graph
    from .sweep_rows import Kept


def graph_beneath(path: Path, study: Study) -> "Graph":
    """The graph of a file, if it is one of the study's machine in the study's parameter.

    Raises
    ------
    ValueError
        With a sentence that names the fields that differ and their values.
    """
    graph = load_file(path)
    if graph.parameter != study.parameter:
        raise ValueError(f"{path} continues in {graph.parameter}, the study sweeps over {study.parameter}.")
    theirs, ours = _graph_machine(graph), _study_machine(study)
    differing = [
        f"{name} = {_shown(theirs[name])} there and {_shown(ours[name])} in the study"
        for name in ours
        if name != study.parameter and name in theirs and not _same(theirs[name], ours[name])
    ]
    if differing:
        raise ValueError(
            f"--over {path}: this is the graph of another machine: {'; '.join(differing)}; "
            f"make the graph of this one first: contvines diagram {study.path}."
        )
    return graph


def _graph_machine(graph: "Graph") -> dict[str, Any]:
    """Name and parameters of a graph's machine; the excitation is known to its branches alone."""
    from orbits.machines.catalogue import build
    from orbits.machines.names import NAMES

    known = dict(graph.model)
    if "page" in known:
        return known
    for branch in graph.branches.values():
        params = branch.description.get("params")
        if params is None or known.get("name") not in NAMES:
            continue
        return {"name": known["name"], **dict(zip(build(known).parameter_names, params))}
    return known


def _study_machine(study: Study) -> dict[str, Any]:
    model = study.model
    if study.sort is Sort.PHYSICAL:
        return {"name": study.name, **model.named(model.vector())}
    vector = model.vector({**study.loose, study.parameter: study.parameters[study.parameter]})
    return {"name": model.name, **model.named(vector)}


def _same(a: float | str, b: float | str) -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    return math.isclose(a, b, rel_tol=Settings.rounding, abs_tol=TINY)


def _shown(value: object) -> str:
    return repr(value) if isinstance(value, str) else f"{value:.15g}"


def picture(
    rows: "list[Kept]", study: Study, graph: "Graph | None", size: tuple[float, float] | None = None
) -> "Figure":
    """The attractors of a sweep as dots, over a graph if there is one."""
    from contvines.plots.sweep import plot_sweep

    model = study.model
    look: dict[str, Any] = {
        "units": model.units,
        "notation": model.notation,
        "figsize": size,
    }
    wandering = [(row.value, dot) for row in rows if not row.recurrent for dot in row.dots]
    steady = [row for row in rows if row.recurrent]
    measure = flow_of(model).default_measure(model)
    if measure != "B":  # one number for the whole motion
        points = [(row.value, dot) for row in steady for dot in row.dots]
        # bands are of displacements
        bands: list[Any] = [(row.value, *row.band) for row in rows if row.band and measure.startswith("max_")]
        return plot_sweep(points, study.parameter, graph, measure, wandering=wandering, bands=bands, **look)
    first: list[tuple[float, float]] = []
    others: list[tuple[float, float]] = []
    lines = _lines(graph) if graph is not None else []
    for row in steady:
        place = _drawn_impact(row, lines) if graph is not None else None
        for i, dot in enumerate(row.dots):
            (first if graph is None or i == place else others).append((row.value, dot))
    return plot_sweep(first, study.parameter, graph, "B", others=others, wandering=wandering, **look)


def _lines(graph: "Graph") -> list[tuple[Any, Any, Any]]:
    """Word, parameter values and B at the word's first impact of every branch that has one."""
    from contvines.graph.measures import measured

    found = []
    for branch in graph.branches.values():
        about = branch.description
        if about.get("events") and len(branch) > 1:
            word = Word.described(about)
            if word.impacts:
                found.append((word, branch.values, measured(branch, "B")))
    return found


def _drawn_impact(row: "Kept", lines: list[tuple[Any, Any, Any]]) -> int | None:
    """Which of a motion's impacts is the first one of its branch's word, whose B the branch's line shows.

    Where a rotation or the mirror image of the word is the word again, several impacts may be: the mirror
    image of an asymmetric orbit is the same orbit, and the line shows the nearest. None if no branch has the word.
    """
    import numpy as np

    from orbits.words import WordError

    candidates: list[tuple[float, int]] = []
    for word, values, heights in lines:
        try:
            own = Word.parse(row.word, word.frictionless)
        except WordError:
            continue
        if len(own.events) != len(word.events):
            continue
        inside = np.flatnonzero((values[:-1] - row.value) * (values[1:] - row.value) <= 0.0)
        if not len(inside):
            continue
        width = values[inside + 1] - values[inside]
        share = np.divide(
            row.value - values[inside], width, out=np.zeros_like(width), where=np.abs(width) > 0.0
        )
        there = heights[inside] + share * (heights[inside + 1] - heights[inside])
        lead = next(i for i, letter in enumerate(word.events) if letter in "LR")
        places = [i for i, letter in enumerate(own.events) if letter in "LR"]
        for shift in range(len(own.events)):
            turned = own.rotate(shift)
            if word in (turned, turned.mirror()):
                place = places.index((shift + lead) % len(own.events))
                if place < len(row.dots):
                    candidates.append((float(np.abs(there - row.dots[place]).min()), place))
    return min(candidates)[1] if candidates else None
