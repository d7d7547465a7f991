"""`contvines survey STUDY.toml`: a diagram of each of many machines, and what comes out of them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from contvines.command.frame import beside, draw, refuse_source, tell
from contvines.command.options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    argument,
    option,
    refuse_alone,
)

if TYPE_CHECKING:
    from contvines.survey import Survey


def survey(
    context: typer.Context,
    study: Annotated[Path, argument("STUDY.toml", "A study with a section [survey].")],
    output: Annotated[
        Path | None,
        option(
            "-o, --output FILE.nc",
            "Result file; by default STUDY-survey.nc in this folder, with a CSV beside it.",
        ),
    ] = None,
    plot: PlotOption = None,
    outcome: Annotated[str | None, option("--outcome", "Outcome to draw; by default the first.")] = None,
    workers: Annotated[
        int | None,
        option("--workers", "Number of processes on this computer; by default one per core.", min=1),
    ] = None,
    cluster: Annotated[
        str | None,
        option("--cluster ADDRESS", "Address of a dask cluster to use instead: tcp://host:port."),
    ] = None,
    best: Annotated[
        str | None,
        option("--best TEXT", 'The goal, for example "lowest worst-case peak".'),
    ] = None,
    over: Annotated[
        list[str] | None,
        option("--over NAME", "With --best: the parameter to choose (one or two)."),
    ] = None,
    covered: Annotated[
        float | None,
        option(
            "--covered SHARE",
            "With --best: least share of the interval in which the response must be known; by default 0.999.",
            min=0.0,
            max=1.0,
        ),
    ] = None,
    fresh: FreshOption = False,
    json_: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Diagrams of many machines: grids, tolerances, samples; an interrupted run goes on."""
    from contvines.command.compose import check_shaken
    from contvines.command.study import read_study
    from contvines.command.surveying import surveyed
    from contvines.export import check_target
    from contvines.survey.outcomes import KNOWN

    read = read_study(study)
    check_shaken(read, read.survey.vary)
    target = output or beside(study, "-survey.nc")
    refuse_source(target, study)
    check_target(target, "nc")
    check_target(target.with_suffix(".csv"), "csv")
    refuse_alone(context, over="--best", covered="--best")
    if workers is not None and cluster is not None:
        raise ValueError(
            f"--workers {workers} and --cluster {cluster} exclude each other; leave one of them out."
        )
    if best is None:
        found = surveyed(read, target, workers, cluster, fresh, quiet)
        if json_ or not quiet:
            tell(found, as_json(found) if json_ else None)
        draw(plot, lambda: found.plot(outcome), quiet)
        return
    from contvines.command.best import asking, check_over, read_wish, tell_choice

    wish = read_wish(best)
    check_over(read, over or [])
    read = asking(read, wish.outcome)
    found = surveyed(read, target, workers, cluster, fresh, quiet)
    tell_choice(read, best, KNOWN if covered is None else covered, found, json_, quiet, plot)


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
