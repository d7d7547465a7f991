"""`contvines survey STUDY.toml`: a diagram of each of many machines, and what comes out of them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from contvines.command.study import Study
    from contvines.survey import Survey


def survey(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="The study, with a section \\[survey].")
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE.nc",
            help="Where to; by default STUDY-survey.nc here, CSV beside it.",
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE.png", help="Draw an outcome: a map, or a curve with bands."),
    ] = None,
    outcome: Annotated[
        str | None, typer.Option("--outcome", help="Which outcome to draw; by default the first.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, help="Processes of this machine; all cores by default.")
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option("--cluster", metavar="ADDRESS", help="A dask cluster instead: tcp://host:port."),
    ] = None,
    best: Annotated[
        str | None,
        typer.Option("--best", metavar="TEXT", help='What is wanted, for example "lowest worst-case peak".'),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option("--over", metavar="NAME", help="With --best: what may be chosen, one or two."),
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no summary.")] = False,
) -> None:
    """Survey many machines; goes on with an unfinished survey."""
    from contvines.command.compose import beside, checked_study, say

    read = checked_study(study)
    target = output or beside(study, "-survey.nc")
    _check_places(study, target, plot)
    if over and best is None:
        raise ValueError(f"--over {' '.join(over)}: this goes with --best; say what is wanted.")
    if workers is not None and cluster is not None:
        raise ValueError(
            f"--workers {workers} and --cluster {cluster} exclude each other; leave one of them out."
        )
    if best is not None:
        from contvines.command.best import choose

        choose(read, best, over or [], target, workers, cluster, plot, json_, quiet)
        return
    found = surveyed(read, target, workers, cluster, quiet)
    if json_:
        from contvines.export import json_text

        typer.echo(json_text(as_json(found)))
    elif not quiet:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.figures import save_figure

        save_figure(found.plot(outcome), plot)
        say(f"drawn in {plot}", quiet)


def surveyed(study: "Study", target: Path, workers: int | None, cluster: str | None, quiet: bool) -> "Survey":
    """The survey of a study, from its file if that is finished."""
    from contvines.command.compose import Interrupted, say
    from contvines.command.survey_study import family_of, outcomes_of, plan_and_machine, units_of
    from contvines.survey import load_survey
    from contvines.survey.survey import digest_of
    from contvines.survey.survey import survey as run
    from orbits.precompile import compile_ahead

    plan, model = plan_and_machine(study)
    asked = {"study": study.describe(), "survey": study.survey.model_dump(exclude={"vary"})}
    options = {"depth": study.depth, "virtual": study.virtual, "settings": study.settings}
    simulated = {key: getattr(study.survey, key) for key in ("gaps", "values", "starts")}
    if target.exists():
        kept = load_survey(target)
        if kept.about.get("digest") == digest_of(plan, study.parameter, study.within, asked):
            say(f"{target} holds the finished result of this survey; nothing to compute.", quiet)
            return kept
    outcomes, family = outcomes_of(study), family_of(study, model)
    journal = target.with_name(target.name + ".unfinished")
    compile_ahead(study.name, "contvines.events.scan:prepare")
    with without_main(), counted(len(plan), quiet) as tell:
        try:
            found = run(
                family, plan, over=study.parameter, within=study.within, outcomes=outcomes, workers=workers, cluster=cluster,
                journal=journal, units=units_of(study, model), about=asked, progress=tell, **simulated, **options,
            )  # fmt: skip
        except KeyboardInterrupt:
            raise Interrupted(
                f"all finished machines are kept in {journal}; the same command goes on from there"
            ) from None
        except ValueError as error:
            raise ValueError(f"{study.path}: {str(error).rstrip('.')}.") from error
    try:
        found.save(target)
    except OSError as error:
        raise ValueError(f"{target}: cannot be written ({error.strerror}).") from None
    journal.unlink(missing_ok=True)
    say(f"kept in {target} and {target.with_suffix('.csv')}", quiet)
    return found


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


@contextmanager
def without_main() -> Iterator[None]:
    """Worker processes do not run the script that started this command: nothing of it is needed there."""
    import sys

    main = sys.modules["__main__"]
    kept = {name: getattr(main, name, None) for name in ("__file__", "__spec__")}
    for name in kept:
        setattr(main, name, None)
    try:
        yield
    finally:
        for name, value in kept.items():
            setattr(main, name, value)


class counted:
    """Counts machines on a terminal, silent elsewhere."""

    def __init__(self, total: int, quiet: bool) -> None:
        import sys

        self.total, self.shown, self.progress = total, sys.stderr.isatty() and not quiet, None

    def __enter__(self) -> Any:
        if self.shown:
            from rich.console import Console
            from rich.progress import Progress

            self.progress = Progress(console=Console(stderr=True), transient=True)
            self.progress.start()
            self.task = self.progress.add_task("machines", total=self.total)
        return self

    def __call__(self, row: Any) -> None:
        if self.progress is not None:
            self.progress.advance(self.task)

    def __exit__(self, *_: object) -> None:
        if self.progress is not None:
            self.progress.stop()


def _check_places(study: Path, target: Path, plot: Path | None) -> None:
    from contvines.export import check_target

    if target.resolve() == study.resolve():
        raise ValueError(f"{target}: this is the study itself; choose another name with -o.")
    check_target(target, "nc")
    check_target(target.with_suffix(".csv"), "csv")
    if plot is not None:
        from contvines.plots.figures import check_picture

        check_picture(plot)
