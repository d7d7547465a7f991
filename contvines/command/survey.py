"""`contvines survey STUDY.toml`: a diagram of each of many machines, and what comes out of them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from contvines.command.frame import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    beside,
    check_plot,
    draw,
    refuse_source,
    tell,
)

if TYPE_CHECKING:
    from contvines.survey import Survey


def survey(
    study: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="A study with a section [survey].")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE.nc",
            help="Result file; by default STUDY-survey.nc in this folder, with a CSV beside it.",
        ),
    ] = None,
    plot: PlotOption = None,
    outcome: Annotated[
        str | None, typer.Option("--outcome", help="Outcome to draw; by default the first.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", min=1, help="Number of processes on this computer; by default one per core."
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster", metavar="ADDRESS", help="Address of a dask cluster to use instead: tcp://host:port."
        ),
    ] = None,
    best: Annotated[
        str | None,
        typer.Option("--best", metavar="TEXT", help='The goal, for example "lowest worst-case peak".'),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option("--over", metavar="NAME", help="With --best: the parameter to choose (one or two)."),
    ] = None,
    covered: Annotated[
        float | None,
        typer.Option(
            "--covered",
            metavar="SHARE",
            min=0.0,
            max=1.0,
            help="With --best: least share of the interval in which the response must be known; by default 0.999.",
        ),
    ] = None,
    fresh: FreshOption = False,
    json_: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Diagrams of many machines: grids, tolerances, samples; an interrupted run goes on."""
    from contvines.command.compose import check_shaken
    from contvines.command.study import read_study
    from contvines.export import check_target

    read = read_study(study)
    check_shaken(read, read.survey.vary)
    target = output or beside(study, "-survey.nc")
    refuse_source(target, study)
    check_target(target, "nc")
    check_target(target.with_suffix(".csv"), "csv")
    check_plot(plot)
    if over and best is None:
        raise ValueError(f"--over {' '.join(over)}: this goes with --best; say what is wanted.")
    if covered is not None and best is None:
        raise ValueError(f"--covered {covered:g}: this goes with --best; say what is wanted.")
    if workers is not None and cluster is not None:
        raise ValueError(
            f"--workers {workers} and --cluster {cluster} exclude each other; leave one of them out."
        )
    if best is not None:
        from contvines.command.best import choose

        choose(read, best, over or [], covered, target, workers, cluster, plot, json_, fresh, quiet)
        return
    from contvines.command.surveying import surveyed

    found = surveyed(read, target, workers, cluster, fresh, quiet)
    if json_ or not quiet:
        tell(found, as_json(found) if json_ else None)
    draw(plot, lambda: found.plot(outcome), quiet)


def as_json(found: "Survey") -> dict[str, Any]:
    """A survey as one JSON object: a row per machine."""
    rows = [
        {
            **values,
            **{name: float(column.ravel()[i]) for name, column in found.columns.items()},
            "note": str(found.notes.ravel()[i]),
        }
        for i, values in enumerate(found.plan.systems())
    ]
    said: dict[str, Any] = {"units": found.units} if found.units else {}
    return {"parameters": list(found.plan.names), "outcomes": list(found.columns), **said, "rows": rows}
