"""`contvines sweep`: brute-force simulation over the continuation parameter."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from contvines.command.frame import (
    Interrupted,
    beside,
    check_plot,
    draw,
    held,
    refuse_source,
    say,
)
from contvines.command.options import FreshOption, PlotOption, QuietOption, SizeOption
from contvines.text_table import Table, terminal_width

if TYPE_CHECKING:
    from .study import Study
    from .sweep_rows import Kept


def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="The study; a section [sweep] is optional.")
    ],
    down: Annotated[bool, typer.Option("--down", help="From the interval's upper end to the lower.")] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.csv", help="Where to; by default STUDY-sweep.csv here."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    over: Annotated[
        Path | None, typer.Option("--over", metavar="FILE.vines", help="Draw them over these branches.")
    ] = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
) -> None:
    """Simulate over the parameter, carrying the state on; goes on with an unfinished sweep."""
    from contvines.command.compose import check_shaken
    from contvines.command.study import read_study
    from contvines.command.sweep_rows import header_of, journal_of, refuse_another
    from contvines.export import check_target

    read = read_study(study)
    check_shaken(read)
    target = output or beside(study, "-sweep.csv")
    refuse_source(target, study)
    check_target(target, "csv")
    graph: Any = None
    if over is not None:
        from contvines.command.sweep_picture import graph_beneath

        graph = graph_beneath(over, read)
        if plot is None:
            raise ValueError(f"--over {over}: there is nothing to draw over; give --plot FILE.png, too.")
    check_plot(plot, size)
    with held(target, quiet, fresh, (journal_of(target),)):
        refuse_another(target, header_of(read, down))
        rows = _simulate(read, down, target, quiet)
    say(f"kept in {target}", quiet)
    if not quiet:
        typer.echo(_summary(rows, read.parameter))
    from contvines.command.sweep_picture import picture

    draw(plot, lambda: picture(rows, read, graph, size), quiet)


def _simulate(study: "Study", down: bool, target: Path, quiet: bool) -> "list[Kept]":
    """All rows, each written to the file as soon as it is there; those of an unfinished run are not repeated."""
    import numpy as np

    from contvines.command.compose import machine
    from contvines.command.sweep_rows import FIRST, Rows, kept
    from contvines.progress import counted
    from orbits.attractors.search import measure_names
    from orbits.attractors.sweep import sweep as simulate

    model = machine(study)
    low, high = study.sweep.within or study.within
    values = np.linspace(low, high, study.sweep.count)[:: -1 if down else 1]
    others: dict[str, Any] = {k: v for k, v in study.loose.items() if k != study.parameter}
    names = [n for n in measure_names(model) if n not in FIRST]
    with (
        Rows(target, study, down, names) as file,
        counted(len(values), "values", not quiet, done=len(file.rows)) as count,
    ):
        done = len(file.rows)
        if done:
            say(f"{target} is unfinished: going on after {done} of {len(values)} values.", quiet)

        def keep(row: Any) -> None:
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


def _summary(rows: "list[Kept]", parameter: str) -> str:
    """Runs of equal attractors, one line each."""
    from contvines.graph.shortening import short_word

    runs = []
    first = 0
    for i in range(1, len(rows) + 1):
        if i == len(rows) or _kind(rows[i]) != _kind(rows[first]):
            row, last = rows[first], rows[i - 1]
            periods = f"k={row.periods}" if row.word else ""
            runs.append(
                (f"{row.value:.6g} to {last.value:.6g}", row.attractor, periods, short_word(row.word))
            )
            first = i
    head = (parameter, "settles on", "periods", "word")
    return "\n".join(Table(head, runs, spare=("periods",)).lines(terminal_width()))


def _kind(row: "Kept") -> tuple[Any, ...]:
    return row.attractor, row.word, row.periods
