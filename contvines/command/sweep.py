"""`contvines sweep`: brute-force simulation over the continuation parameter."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from contvines.command.frame import Interrupted, beside, draw, held, refuse_source, say, tell
from contvines.command.options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    SizeOption,
    argument,
    option,
)
from contvines.shared.motions import BAND
from contvines.shared.number_text import figures
from contvines.text_table import Table, fitted, terminal_width

if TYPE_CHECKING:
    from contvines.graph.graph import Graph
    from orbits.attractors.sweeping import SweepRow

    from .study import Study
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
    from contvines.command.compose import check_shaken
    from contvines.command.study import read_study
    from contvines.command.sweep_rows import header_of, journal_of, refuse_another, rows_as_json
    from contvines.export import check_target

    read = read_study(study)
    check_shaken(read)
    target = output or beside(study, "-sweep.csv")
    refuse_source(target, study)
    check_target(target, "csv")
    graph: Graph | None = None
    if over is not None:
        from contvines.command.sweep_picture import graph_beneath

        graph = graph_beneath(over, read)
        if plot is None:
            raise ValueError(f"--over {over}: there is nothing to draw over; give --plot FILE.png, too.")
    with held(target, quiet, fresh, (journal_of(target),)):
        refuse_another(target, header_of(read, down))
        rows = _simulate(read, down, target, quiet)
    say(f"kept in {target}", quiet)
    if json_ or not quiet:
        tell(_summary(rows, read), rows_as_json(rows, read) if json_ else None)
    from contvines.command.sweep_picture import picture

    draw(plot, lambda: picture(rows, read, graph, size), quiet)


def _simulate(study: "Study", down: bool, target: Path, quiet: bool) -> "list[Kept]":
    """All rows, each written to the file as soon as it is there; those of an unfinished run are not repeated."""
    import numpy as np

    from contvines.command.compose import machine
    from contvines.command.sweep_rows import Rows, kept, measured_names
    from contvines.progress import counted
    from orbits.attractors.sweeping import sweep as simulate

    model = machine(study)
    low, high = study.sweep.within or study.within
    values = np.linspace(low, high, study.sweep.count)[:: -1 if down else 1]
    others: dict[str, Any] = {k: v for k, v in study.loose.items() if k != study.parameter}
    names = measured_names(study)
    with (
        Rows(target, study, down, names) as file,
        counted(len(values), "values", not quiet, done=len(file.rows)) as count,
    ):
        done = len(file.rows)
        if done:
            say(f"{target} is unfinished: going on after {done} of {len(values)} values.", quiet)

        def keep(row: "SweepRow") -> None:
            file.keep(kept(row, "down" if down else "up", names))
            if count is not None:
                count(row)

        then = "the same command goes on from there, from the state reached" if file.lasting else "no more"
        try:
            if done < len(values):
                simulate(
                    model,
                    study.parameter,
                    values[done:],
                    start=np.array(file.rows[-1].state) if done else None,
                    transient=study.sweep.transient,
                    max_period=study.sweep.max_period,
                    progress=keep,
                    **others,
                )
        except KeyboardInterrupt:
            raise Interrupted(
                f"{len(file.rows)} of {len(values)} values are kept in {target}; {then}"
            ) from None
    return file.rows


def _summary(rows: "list[Kept]", study: "Study") -> str:
    """Runs of equal attractors, one line each, and what is modulated."""
    from itertools import groupby

    from contvines.graph.shortening import short_word

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
