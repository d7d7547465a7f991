"""`contvines sweep`: simulation at one value after another of the continuation parameter, and its picture, alone or over the branches of a graph."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ..shared.motions import BAND
from ..shared.numbers import figures
from ..text_table import Table, fitted, terminal_width
from .frame import Interrupted, draw, held, load_file, place_of, say, tell
from .options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    SizeOption,
    argument,
    option,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from orbits.attractors.sweeping import SweepRow

    from ..graph import Graph
    from .study_data import Study
    from .sweep_rows import Kept


def sweep(
    study: Annotated[Path, argument("STUDY.toml", "A study; its section [sweep] is optional.")],
    down: Annotated[bool, option("--down", "From the upper end of the interval to the lower.")] = False,
    output: Annotated[
        Path | None,
        option("-o, --output FILE.csv", "Result file; by default STUDY-sweep.csv in this folder."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    over: Annotated[
        Path | None,
        option("--over FILE.vines", "Draw the sweep over the branches of this file."),
    ] = None,
    fresh: FreshOption = False,
    json_: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Simulate over the parameter, each value from the last state; an interrupted run goes on."""
    from .compose import check_shaken
    from .study import read_study
    from .sweep_rows import header_of, journal_of, refuse_another, rows_as_json

    read = read_study(study)
    check_shaken(read)
    target = place_of(output, study, "-sweep.csv")
    graph: Graph | None = None
    if over is not None:
        graph = graph_beneath(over, read)
        if plot is None:
            raise ValueError(f"--over {over}: there is nothing to draw over; give --plot FILE.png, too.")
    with held(target, quiet, fresh, (journal_of(target),)):
        refuse_another(target, header_of(read, down))
        rows = _simulate(read, down, target, quiet)
    say(f"kept in {target}", quiet)
    if json_ or not quiet:
        tell(_summary(rows, read), rows_as_json(rows, read) if json_ else None)

    draw(plot, lambda: picture(rows, read, graph, size), quiet)


def _simulate(study: Study, down: bool, target: Path, quiet: bool) -> list[Kept]:
    """Compute all rows of a sweep; each is written to the file at once, and rows of an unfinished run are reused."""
    import numpy as np

    from orbits.attractors.sweeping import sweep as simulate

    from ..long_work import counted
    from .compose import machine
    from .sweep_rows import Rows, kept

    model = machine(study)
    low, high = study.sweep.within or study.within
    values = np.linspace(low, high, study.sweep.count)[:: -1 if down else 1]
    others: dict[str, Any] = {k: v for k, v in study.loose.items() if k != study.parameter}
    with (
        Rows(target, study, down) as file,
        counted(len(values), "values", not quiet, done=(done := len(file.found))) as count,
    ):
        if done:
            say(f"{target} is unfinished: going on after {done} of {len(values)} values.", quiet)

        def keep(row: SweepRow) -> None:
            file.keep(kept(row, "down" if down else "up", file.names))
            if count is not None:
                count(row)

        then = "the same command goes on from there, from the state reached" if file.lasting else "no more"
        try:
            if done < len(values):
                simulate(
                    model,
                    study.parameter,
                    values[done:],
                    start=np.array(file.found[-1].state) if done else None,
                    transient=study.sweep.transient,
                    max_period=study.sweep.max_period,
                    progress=keep,
                    **others,
                )
        except KeyboardInterrupt:
            raise Interrupted(
                f"{len(file.found)} of {len(values)} values are kept in {target}; {then}"
            ) from None
    return file.found


def _summary(rows: list[Kept], study: Study) -> str:
    """Return the summary of a sweep: a line for each interval with the same attractor, and one about modulation."""
    from itertools import groupby

    from ..graph.table import short_word

    runs, step = [], abs(rows[-1].value - rows[0].value) / max(len(rows) - 1, 1)
    for _, equal in groupby(rows, lambda row: (row.attractor, row.word, row.periods)):
        first, *_, last = (one := list(equal))[0], one[-1]
        periods = f"k={first.periods}" if first.word else ""
        ends = dict.fromkeys(figures(row.value, step) for row in (first, last))
        runs.append((" to ".join(ends), first.attractor, periods, short_word(first.word)))
    head = (study.parameter, "settles on", "periods", "word")
    lines = Table(head, runs, spare=("periods",)).lines(terminal_width())
    if banded := [row for row in rows if row.band]:
        low, high = min(row.band[0] for row in banded), max(row.band[2] for row in banded)
        kinds = Counter(row.modulation for row in banded).most_common()
        unit = study.model.units.get(BAND[0], "")
        lines.append(
            f"modulated at {len(banded)} of {len(rows)} values ({'; '.join(f'{n} {kind}' for kind, n in kinds)}): largest response "
            f"in a forcing period from {figures(low)} to {figures(high)} {unit}".rstrip()
        )
    return "\n".join(map(fitted, lines))


def graph_beneath(path: Path, study: Study) -> Graph:
    """Load the graph to draw below a sweep; it must be of the study's machine and parameter.

    Raises
    ------
    ValueError
        If it is not; the message names the fields that differ and their values.
    """
    graph = load_file(path)
    if graph.parameter != study.parameter:
        raise ValueError(f"{path} continues in {graph.parameter}, the study sweeps over {study.parameter}.")
    theirs, ours = _graph_machine(graph), _study_machine(study)
    differing = [
        f"{name} = {_shown(theirs[name])} there and {_shown(own)} in the study"
        for name, own in ours.items()
        if name != study.parameter and name in theirs and not _same(theirs[name], own)
    ]
    if differing:
        raise ValueError(
            f"--over {path}: this is the graph of another machine: {'; '.join(differing)}; "
            f"make the graph of this one first: contvines diagram {study.path}."
        )
    return graph


def _graph_machine(graph: Graph) -> dict[str, Any]:
    """Return name and parameters of a graph's machine; the parameters of the excitation come from its branches."""
    from orbits.flows import machine_of
    from orbits.machines.names import NAMES

    known = dict(graph.model)
    if "page" in known or known.get("name") not in NAMES:
        return known
    every = (branch.description.get("params") for branch in graph.branches.values())
    params = next((params for params in every if params is not None), None)
    if params is None:
        return known
    return {"name": known["name"], **dict(zip(machine_of(known).parameter_names, params))}


def _study_machine(study: Study) -> dict[str, Any]:
    from .study_data import Sort

    model = study.model
    if study.sort is Sort.PHYSICAL:
        return {"name": study.name, **model.named(model.vector())}
    vector = model.vector({**study.loose, study.parameter: study.parameters[study.parameter]})
    return {"name": model.name, **model.named(vector)}


def _same(a: float | str, b: float | str) -> bool:
    from ..continuation.settings import Settings
    from ..shared.numbers import TINY

    if isinstance(a, str) or isinstance(b, str):
        return a == b
    return math.isclose(a, b, rel_tol=Settings.rounding, abs_tol=TINY)


def _shown(value: object) -> str:
    return repr(value) if isinstance(value, str) else f"{value:.15g}"


def picture(
    rows: list[Kept], study: Study, graph: Graph | None, size: tuple[float, float] | None = None
) -> Figure:
    """Draw the attractors of a sweep as dots, over a graph if there is one."""
    from orbits.flows import flow_of

    from ..plots.sweep import plot_sweep

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
        # only displacements have a band
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


def _lines(graph: Graph) -> list[tuple[Any, Any, Any]]:
    """Return word, parameter values and B at the word's first impact of every branch with an impact."""
    from orbits.words import Word

    from ..graph.stretches import measured

    found = []
    for branch in graph.branches.values():
        about = branch.description
        if about.get("events") and len(branch) > 1:
            word = Word.described(about)
            if word.impacts:
                found.append((word, branch.values, measured(branch, "B")))
    return found


def _drawn_impact(row: Kept, lines: list[tuple[Any, Any, Any]]) -> int | None:
    """Return the index of the impact of a motion that corresponds to the first impact of its branch's word, whose B the branch's line shows.

    If a rotation or the mirror image of the word equals the word, several impacts are possible, also as the mirror image of an
    asymmetric orbit lies on the same branch; the impact nearest to the line is taken. None if no branch has the word.
    """
    import numpy as np

    from orbits.words import Word, WordError

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
