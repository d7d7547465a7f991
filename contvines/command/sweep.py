"""`contvines sweep`: brute-force simulation over the continuation parameter."""

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from contvines.command.study import Study

COLUMNS = ("value", "direction", "attractor", "word", "periods", "impacts")


def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="The study; a section \\[sweep] is optional.")
    ],
    down: Annotated[bool, typer.Option("--down", help="From the interval's upper end to the lower.")] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.csv", help="Where to; by default STUDY-sweep.csv here."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(
            "--plot", metavar="FILE.png", help="Draw the attractors: B at every impact, or largest |q1|."
        ),
    ] = None,
    over: Annotated[
        Path | None, typer.Option("--over", metavar="FILE.vines", help="Draw them over these branches.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no summary.")] = False,
) -> None:
    """Simulate over the parameter, carrying the state on; tell the attractor at each value."""
    from contvines.command.compose import beside, say
    from contvines.command.study import read_study
    from contvines.export import check_target

    read = read_study(study)
    target = output or beside(study, "-sweep.csv")
    if target.resolve() == study.resolve():
        raise ValueError(f"{target}: this is the study itself; choose another name with -o.")
    check_target(target, "csv")
    graph: Any = None
    if over is not None:
        from contvines.store import load

        graph = load(over)
        if graph.parameter != read.parameter:
            raise ValueError(
                f"{over} continues in {graph.parameter}, the study sweeps over {read.parameter}."
            )
        if plot is None:
            raise ValueError(f"--over {over}: there is nothing to draw over; give --plot FILE.png, too.")
    if plot is not None:
        from contvines.plots.style import check_picture

        check_picture(plot)
    rows = _simulate(read, down, target, quiet)
    say(f"kept in {target}", quiet)
    if not quiet:
        typer.echo(_summary(rows, read.parameter))
    if plot is not None:
        from contvines.plots.style import save_figure
        from contvines.plots.sweep import plot_sweep

        peaks = (
            bool(rows) and "max_abs_q1" in rows[0].measures
        )  # the coupled machine: what a frequency response shows
        if peaks:
            points = [(row.value, row.measures["max_abs_q1"]) for row in rows]
        else:
            points = [(row.value, b) for row in rows for b in _impacts(row)]
        save_figure(plot_sweep(points, read.parameter, graph, "max_abs_q1" if peaks else "B"), plot)
        say(f"drawn in {plot}", quiet)


def _simulate(study: "Study", down: bool, target: Path, quiet: bool) -> list[Any]:
    """All rows, each written to the file as soon as it is there."""
    import numpy as np

    from contvines.command.compose import Interrupted, loose, machine
    from orbits.simulation.sweep import measure_names
    from orbits.simulation.sweep import sweep as simulate

    model = machine(study)
    low, high = study.sweep.within or study.within
    values = np.linspace(low, high, study.sweep.count)[:: -1 if down else 1]
    others: dict[str, Any] = {k: v for k, v in loose(study).items() if k != study.parameter}
    names = [n for n in measure_names(model) if n not in COLUMNS]
    rows: list[Any] = []
    with target.open("w", newline="", encoding="utf-8") as file, _counter(len(values), quiet) as count:
        writer = csv.writer(file)
        writer.writerow([*COLUMNS, *names])

        def keep(row: Any) -> None:
            kind = "periodic" if row.attractor == "sliding" else row.attractor
            first = [repr(row.value), row.direction, kind, row.word, row.periods, row.impacts]
            writer.writerow(first + [repr(float(row.measures[n])) for n in names])
            file.flush()
            rows.append(row)
            count()

        try:
            simulate(
                model,
                study.parameter,
                values,
                transient=study.sweep.transient,
                max_period=study.sweep.max_period,
                progress=keep,
                **others,
            )
        except KeyboardInterrupt:
            left = [low, high] if not rows else [low, rows[-1].value] if down else [rows[-1].value, high]
            raise Interrupted(
                f"{len(rows)} of {len(values)} values are kept in {target}; "
                f"[sweep] within = {left} with another -o does the rest"
            ) from None
    return rows


class _counter:
    """Counts values on a terminal, silent elsewhere."""

    def __init__(self, total: int, quiet: bool):
        import sys

        self.total, self.shown = total, sys.stderr.isatty() and not quiet
        self.done, self.progress = 0, None

    def __enter__(self) -> Any:
        if self.shown:
            from rich.console import Console
            from rich.progress import Progress

            self.progress = Progress(console=Console(stderr=True), transient=True)
            self.progress.start()
            self.task = self.progress.add_task("sweep", total=self.total)
        return self

    def __call__(self) -> None:
        if self.progress is not None:
            self.progress.advance(self.task)

    def __exit__(self, *_: object) -> None:
        if self.progress is not None:
            self.progress.stop()


def _summary(rows: list[Any], parameter: str) -> str:
    """Runs of equal attractors, one line each."""
    lines = []
    first = 0
    for i in range(1, len(rows) + 1):
        if i == len(rows) or _kind(rows[i]) != _kind(rows[first]):
            word = f" {rows[first].word}  k = {rows[first].periods}" if rows[first].word else ""
            lines.append(
                f"{parameter} {rows[first].value:.6g} to {rows[i - 1].value:.6g}: {rows[first].attractor}{word}"
            )
            first = i
    return "\n".join(lines)


def _kind(row: Any) -> tuple[Any, ...]:
    return row.attractor, row.word, row.periods


def _impacts(row: Any) -> list[float]:
    """B = (B+ - B-)/2, positive away from the wall, at every impact of the motion.

    B = v' - w', and v' does not change at an impact: B is half the jump of -w'.
    """
    from orbits.simulation.contract import RATE
    from orbits.simulation.sweep import follow

    run = follow(row.detail)
    hits = run.codes < 2
    away = 1.0 - 2.0 * run.codes[hits]  # L = 0, R = 1
    return list(0.5 * away * (run.rows[hits, 3] - run.states[1:][hits, RATE]))
