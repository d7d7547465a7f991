"""The survey of a study: from its file if that is finished, else computed, machine by machine."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contvines.command.study import Study
    from contvines.survey import Survey


def surveyed(study: "Study", target: Path, workers: int | None, cluster: str | None, quiet: bool) -> "Survey":
    """The survey of a study, from its file if that is finished."""
    from contvines.command.compose import Interrupted, say
    from contvines.command.survey_study import (
        asked_of,
        family_of,
        options_of,
        outcomes_of,
        plan_and_machine,
        units_of,
        ways_of,
    )
    from contvines.survey import load_survey
    from contvines.survey.survey import digest_of
    from contvines.survey.survey import survey as run
    from orbits.precompile import compile_ahead

    plan, model = plan_and_machine(study)
    asked = asked_of(study)
    if target.exists():
        kept = load_survey(target)
        if kept.about.get("digest") == digest_of(plan, study.parameter, study.within, asked):
            say(f"{target} holds the finished result of this survey; nothing to compute.", quiet)
            return kept
    outcomes, family = outcomes_of(study), family_of(study, model)
    journal = target.with_name(target.name + ".unfinished")
    if study.machine is None:
        compile_ahead(study.name, "contvines.events.scan:prepare")
    with without_main(), counted(len(plan), quiet) as tell:
        try:
            found = run(
                family, plan, over=study.parameter, within=study.within, outcomes=outcomes, workers=workers, cluster=cluster,
                journal=journal, units=units_of(study, model), about=asked, progress=tell, **ways_of(study), **options_of(study),
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

            # no thread that draws by itself: beside one, workers could not be copies of this process
            self.progress = Progress(console=Console(stderr=True), transient=True, auto_refresh=False)
            self.progress.start()
            self.task = self.progress.add_task("machines", total=self.total)
        return self

    def __call__(self, row: Any) -> None:
        if self.progress is not None:
            self.progress.update(self.task, advance=1, refresh=True)

    def __exit__(self, *_: object) -> None:
        if self.progress is not None:
            self.progress.stop()
