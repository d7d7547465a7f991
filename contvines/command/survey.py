"""`contvines survey STUDY.toml`: diagrams of many machines, and their outcomes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .frame import draw, held, interruptible, journal_of, place_of, refuse_another, say, tell
from .options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    argument,
    option,
    refuse_alone,
)

if TYPE_CHECKING:
    from ..survey import Survey
    from .study_data import Study


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
    from ..export import check_target
    from .compose import check_shaken
    from .study import read_study

    read, goal = read_study(study), None
    check_shaken(read, read.survey.vary)
    target = place_of(output, study, "-survey.nc")
    check_target(target.with_suffix(".csv"), "csv")
    refuse_alone(context, over="--best", covered="--best")
    if workers is not None and cluster is not None:
        raise ValueError(
            f"--workers {workers} and --cluster {cluster} exclude each other; leave one of them out."
        )
    if best is not None:
        from .best import asking, check_over, read_goal

        goal = read_goal(best)
        check_over(read, over or [])
        read = asking(read, goal.outcome)
    found = surveyed(read, target, workers, cluster, fresh, quiet)
    if goal is not None:
        from .best import tell_choice

        tell_choice(read, str(best), covered, found, json_, quiet, plot)
    else:
        if json_ or not quiet:
            tell(found, as_json(found) if json_ else None)
        draw(plot, lambda: found.plot(outcome), quiet)


def as_json(found: Survey) -> dict[str, Any]:
    """Return a survey as one JSON object with a row per machine."""
    rows = [
        {
            **values,
            **{name: float(column.ravel()[i]) for name, column in found.columns.items()},
            "note": str(found.notes.ravel()[i]),
        }
        for i, values in enumerate(found.plan.systems())
    ]
    units: dict[str, Any] = {"units": found.units} if found.units else {}
    return {"parameters": list(found.plan.names), "outcomes": list(found.columns), **units, "rows": rows}


def surveyed(
    study: Study, target: Path, workers: int | None, cluster: str | None, fresh: bool, quiet: bool
) -> Survey:
    """Return the survey of a study, from its file if that is finished, otherwise computed machine by machine.

    Raises
    ------
    ValueError
        If the file contains another survey, or the study cannot be surveyed.
    """
    from ..survey import load_survey
    from ..survey.survey import digest_of
    from ..survey.survey import survey as run
    from .study_data import refused
    from .survey_study import (
        asked_of,
        family_of,
        outcomes_of,
        plan_and_machine,
        units_of,
        ways_of,
    )

    (plan, model), outcomes, asked = plan_and_machine(study), outcomes_of(study), asked_of(study)
    over, within, journal = study.parameter, study.within, journal_of(target)
    digest = digest_of(plan, over, within, asked)
    with held(target, quiet, fresh, (target.with_suffix(".csv"), journal)):
        refuse_another(target, {"contvines": "unfinished survey", "of": digest})
        if target.exists():
            found = load_survey(target)
            if found.about.get("digest") != digest:
                raise ValueError(
                    f"{target}: this file holds another survey (or this one before it was edited); --fresh sets it aside, "
                    "-o gives another name."
                )
            if not journal.exists():
                say(f"{target} holds the finished result of this survey; nothing to compute.", quiet)
                return found
        note = f"all finished machines are kept in {journal}; the same command goes on from there"
        with without_main(), interruptible(note), refused(str(study.path)):
            found = run(
                family_of(study, model), plan, over=over, within=within, outcomes=outcomes, workers=workers, cluster=cluster, journal=journal,
                units=units_of(study, model), about=asked, progress=not quiet, **ways_of(study), **study.options,
            )  # fmt: skip
        try:
            found.save(target)
        except OSError as error:
            raise ValueError(f"{target}: cannot be written ({error.strerror}).") from None
        journal.unlink(missing_ok=True)
        say(f"kept in {target} and {target.with_suffix('.csv')}", quiet)
        return found


@contextmanager
def without_main() -> Iterator[None]:
    """Keep spawned worker processes from running the script that started this command, which they do not need; a context manager."""
    import sys

    main = sys.modules["__main__"]
    saved = {name: getattr(main, name, None) for name in ("__file__", "__spec__")}
    for name in saved:
        setattr(main, name, None)
    try:
        yield
    finally:
        for name, value in saved.items():
            setattr(main, name, value)
