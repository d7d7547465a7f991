"""The survey of a study: from its file if that is finished, else computed, machine by machine."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from contvines.command.frame import held, interruptible, say
from contvines.command.study_data import Study
from contvines.command.survey_study import asked_of, outcomes_of, plan_and_machine
from contvines.command.sweep_rows import journal_of

if TYPE_CHECKING:
    from contvines.survey import Survey


def surveyed(
    study: Study, target: Path, workers: int | None, cluster: str | None, fresh: bool, quiet: bool
) -> "Survey":
    """The survey of a study, from its file if that is finished.

    Raises
    ------
    ValueError
        If the file holds another survey, or the study cannot be surveyed.
    """

    _ = plan_and_machine(study), outcomes_of(study)  # a study that cannot be is refused before its file
    with held(target, quiet, fresh, (target.with_suffix(".csv"), journal_of(target))):
        found = _finished(study, target, quiet)
        return _computed(study, target, workers, cluster, quiet) if found is None else found


def _finished(study: Study, target: Path, quiet: bool) -> "Survey | None":
    """The survey in its file; None if there is none, or its run was ended before it had written all."""
    from contvines.command.sweep_rows import refuse_another
    from contvines.survey import load_survey
    from contvines.survey.survey import digest_of

    plan, _ = plan_and_machine(study)
    digest = digest_of(plan, study.parameter, study.within, asked_of(study))
    refuse_another(target, {"contvines": "unfinished survey", "of": digest})
    if not target.exists():
        return None
    kept = load_survey(target)
    if kept.about.get("digest") != digest:
        raise ValueError(
            f"{target}: this file holds another survey (or this one before it was edited); --fresh sets it aside, "
            "-o gives another name."
        )
    if journal_of(target).exists():
        return None
    say(f"{target} holds the finished result of this survey; nothing to compute.", quiet)
    return kept


def _computed(study: Study, target: Path, workers: int | None, cluster: str | None, quiet: bool) -> "Survey":
    """The survey, machine by machine; those that an unfinished run has kept are not computed again."""
    from contvines.command.survey_study import family_of, options_of, units_of, ways_of
    from contvines.survey.survey import survey as run

    plan, model = plan_and_machine(study)
    outcomes, family, journal = outcomes_of(study), family_of(study, model), journal_of(target)
    note = f"all finished machines are kept in {journal}; the same command goes on from there"
    with without_main(), interruptible(note):
        try:
            found = run(
                family, plan, over=study.parameter, within=study.within, outcomes=outcomes, workers=workers, cluster=cluster,
                journal=journal, units=units_of(study, model), about=asked_of(study), progress=not quiet, **ways_of(study), **options_of(study),
            )  # fmt: skip
        except ValueError as error:
            raise ValueError(f"{study.path}: {str(error).rstrip('.')}.") from error
    try:
        found.save(target)
    except OSError as error:
        raise ValueError(f"{target}: cannot be written ({error.strerror}).") from None
    journal.unlink(missing_ok=True)
    say(f"kept in {target} and {target.with_suffix('.csv')}", quiet)
    return found


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
