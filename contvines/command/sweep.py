"""`contvines sweep`: simulation at one value after another of the continuation parameter, and its picture, alone or over the branches of a graph."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import gettempdir
from typing import TYPE_CHECKING, Annotated, Any

from ..shared import row_journal
from ..shared.files import digest_of
from ..shared.motions import BAND, SILENT
from ..shared.numbers import figures
from ..text_table import Table, fitted, terminal_width
from .frame import Interrupted, draw, held, journal_of, load_file, place_of, refuse_another, say, tell
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

FIRST = ("value", "direction", "attractor", "word", "periods", "impacts")
LAST = ("modulation", "symmetric", "nodes")


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
    from .compose import check_shaken, machine
    from .study import read_study

    read = read_study(study)
    machine(read)
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


def _simulate(study: Study, down: bool, target: Path, quiet: bool) -> list[StoredRow]:
    """Compute all rows of a sweep; each is written to the file at once, and rows of an unfinished run are reused."""
    import numpy as np

    from orbits.attractors.sweeping import sweep as simulate

    from ..long_work import counted

    model = study.model
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

        advice = "the same command goes on from there, from the state reached" if file.lasting else "no more"
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
                f"{len(file.found)} of {len(values)} values are kept in {target}; {advice}"
            ) from None
    return file.found


def _summary(rows: list[StoredRow], study: Study) -> str:
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
    from ..continuation.settings import Settings
    from ..shared.numbers import TINY

    graph = load_file(path)
    if graph.parameter != study.parameter:
        raise ValueError(f"{path} continues in {graph.parameter}, the study sweeps over {study.parameter}.")
    over, model, graph_values = study.parameter, study.model, _machine_of(graph)
    vector = model.vector_at(over, study.parameters[over], study.loose)
    own_values = {"name": model.name, **model.named(vector)}
    close = {"rel_tol": Settings.rounding, "abs_tol": TINY}
    differing = [
        f"{name} = {other!r} there and {value!r} in the study"
        for name, value in own_values.items()
        if name != over
        and (other := graph_values.get(name, value)) != value
        and (isinstance(value, str) or not math.isclose(value, other, **close))
    ]
    if differing:
        raise ValueError(
            f"--over {path}: this is the graph of another machine: {'; '.join(differing)}; "
            f"make the graph of this one first: contvines diagram {study.path}."
        )
    return graph


def _machine_of(graph: Graph) -> dict[str, Any]:
    """Return name and parameters of a graph's machine; the parameters of the excitation come from its branches."""
    from orbits.flows import machine_of
    from orbits.machines.names import NAMES

    model = dict(graph.model)
    if "page" in model or model.get("name") not in NAMES:
        return model
    every = (branch.description.get("params") for branch in graph.branches.values())
    params = next((params for params in every if params is not None), None)
    if params is None:
        return model
    return {"name": model["name"], **dict(zip(machine_of(model).parameter_names, params))}


def picture(
    rows: list[StoredRow], study: Study, graph: Graph | None, size: tuple[float, float] | None = None
) -> Figure:
    """Draw the attractors of a sweep as dots, over a graph if there is one."""
    from orbits.flows import flow_of

    from ..plots.sweep import plot_sweep

    model = study.model
    options: dict[str, Any] = {
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
        return plot_sweep(
            points, study.parameter, graph, measure, wandering=wandering, bands=bands, **options
        )
    first: list[tuple[float, float]] = []
    others: list[tuple[float, float]] = []
    lines = _lines(graph) if graph is not None else []
    for row in steady:
        place = _drawn_impact(row, lines) if graph is not None else None
        for i, dot in enumerate(row.dots):
            (first if graph is None or i == place else others).append((row.value, dot))
    return plot_sweep(first, study.parameter, graph, "B", others=others, wandering=wandering, **options)


def _lines(graph: Graph) -> list[tuple[Any, Any, Any]]:
    """Return word, parameter values and B at the word's first impact of every branch with an impact."""
    from orbits.words import Word

    from ..graph.stretches import measured

    found = []
    for branch in graph.branches.values():
        data = branch.description
        if data.get("events") and len(branch) > 1:
            word = Word.described(data)
            if word.impacts:
                found.append((word, branch.values, measured(branch, "B")))
    return found


def _drawn_impact(row: StoredRow, lines: list[tuple[Any, Any, Any]]) -> int | None:
    """Return the index of the impact of a motion whose B the line of its branch shows; None if no branch has its word.

    The motion, a rotation of its word or its mirror image lies on the branch: the line's impact is the one nearest to the line.
    """
    import numpy as np

    from orbits.words import Word, WordError

    candidates: list[tuple[float, int]] = []
    for word, values, heights in lines:
        try:
            parsed = Word.parse(row.word, word.frictionless)
        except WordError:
            continue
        if parsed.canonical() == word.canonical():
            i = np.flatnonzero((values[:-1] - row.value) * (values[1:] - row.value) <= 0.0)
            width = values[i + 1] - values[i]
            share = (row.value - values[i]) / np.where(width == 0.0, 1.0, width)
            for height in heights[i] + share * (heights[i + 1] - heights[i]):
                candidates += [(abs(height - dot), place) for place, dot in enumerate(row.dots)]
    return min(candidates)[1] if candidates else None


# ---------------------------------------------------------------------- rows
@dataclass(frozen=True)
class StoredRow:
    """A row of a sweep: one value of the parameter and the motion there.

    Attributes
    ----------
    cells : list of str
        The row of the CSV file.
    attractor : str
        Kind of the motion; `sliding` is distinguished from `periodic`.
    recurrent : bool
        Whether the motion recurs.
    modulation : str
        Its modulation; see `contvines.shared.motions`.
    band : list of float
        Lowest, mean and highest of the largest response per forcing period; empty without modulation.
    dots : list of float
        Numbers that a picture shows: the largest |q1|, or B at every impact (beginning with the first one of the word, if there is a word).
    state : list of float
        The final state, from which the next value continues.
    """

    cells: list[str]
    attractor: str
    recurrent: bool
    dots: list[float]
    state: list[float]
    modulation: str = ""
    band: list[float] = field(default_factory=list)

    @property
    def value(self) -> float:
        return float(self.cells[0])

    @property
    def word(self) -> str:
        return self.cells[3]

    @property
    def periods(self) -> int:
        return int(self.cells[4])


def kept(row: SweepRow, direction: str, names: list[str]) -> StoredRow:
    """Convert a row of `orbits.attractors.sweep`; `names` are the measures in the order of the CSV's columns."""
    found, guess = row.detail, row.detail.guess
    kind = "periodic" if row.attractor == "sliding" else row.attractor
    cells = [repr(row.value), direction, kind, row.word, str(row.periods), str(row.impacts)]
    for name in names:
        x = float(row.measures[name])
        cells.append(repr(x) if math.isfinite(x) or name not in (*BAND, SILENT) else "")
    nodes = "" if guess is None else json.dumps([[float(x) for x in node] for node in guess])
    cells += [row.modulation, str(int(found.symmetric)) if found.recurrent else "", nodes]
    band = [float(row.measures[name]) for name in BAND] if row.modulation else []
    return StoredRow(
        cells, row.attractor, found.recurrent, row.dots, [float(x) for x in found.state], row.modulation, band
    )


def rows_as_json(rows: list[StoredRow], study: Study) -> dict[str, Any]:
    """Return the content of the CSV ready for JSON, at full precision, and the share of the values with modulated motions, by kind."""
    names = measured_names(study)
    kinds = dict.fromkeys(row.modulation for row in rows if row.modulation)
    return {
        "parameter": study.parameter,
        "modulated": {kind: sum(row.modulation == kind for row in rows) / len(rows) for kind in kinds},
        "rows": [dict(zip((*FIRST, *names, *LAST), map(_read, row.cells))) for row in rows],
    }


def measured_names(study: Study) -> list[str]:
    """Return the names of the measures in the rows, in the order of the CSV's columns."""
    from orbits.attractors.attractor import measure_names

    return [name for name in measure_names(study.model) if name not in FIRST]


def _read(cell: str) -> object:
    """Convert a cell of the CSV to a JSON value."""
    try:
        return json.loads(cell)
    except ValueError:
        return cell or None


class Rows(row_journal.Rows[StoredRow]):
    """The rows of a sweep on disk, each written at once.

    The CSV file is for the user. The journal beside it (`FILE.csv.unfinished`) has the states, too; it is deleted when the sweep is finished.
    """

    def __init__(self, target: Path, study: Study, down: bool) -> None:
        self.target, self.names = target, measured_names(study)
        from ..graph.table import with_unit

        units = study.model.units
        units = {"value": units.get(study.parameter), **units}
        self.heads = [with_unit(name, units.get(name)) for name in (*FIRST, *self.names, *LAST)]
        self.lasting = target.is_file() or not target.exists()  # a pipe or a terminal has no journal
        if not target.exists():
            journal_of(target).unlink(missing_ok=True)
        super().__init__(journal_of(target) if self.lasting else None, header_of(study, down), StoredRow)

    def __enter__(self) -> Rows:
        try:
            super().__enter__()
            self.table = self.target.open("w", newline="", encoding="utf-8")
        except OSError as error:
            super().__exit__()
            raise ValueError(
                f"{self.target}: cannot be written there ({error.strerror}); "
                f"choose another place with -o, for example -o {Path(gettempdir()) / self.target.name}."
            ) from None
        self._write(self.heads, *(row.cells for row in self.found))
        return self

    def keep(self, row: StoredRow) -> None:
        """Add a row and write it to both files, first to the journal, from which the other is written again."""
        from ..long_work import HELD

        with HELD:
            super().keep(row)
            self._write(row.cells)

    def _write(self, *lines: list[str]) -> None:
        csv.writer(self.table).writerows(lines)
        self.table.flush()

    def __exit__(self, kind: object = None, *_: object) -> None:
        self.table.close()
        super().__exit__()
        if kind is None and self.path is not None:
            self.path.unlink(missing_ok=True)


def header_of(study: Study, down: bool) -> dict[str, str]:
    """Return the first line of a sweep's journal, with a digest of everything that determines its rows; equal for runs with equal results."""
    decides = {"study": study.describe(), "sweep": study.sweep.model_dump(), "down": down}
    return {"contvines": "unfinished sweep", "of": digest_of(decides)}
