"""`survey`: the diagrams of many systems, and what comes out of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kinds import BY_NAME
from ..continuation.settings import hinting
from ..journal import Interrupted, unfinished
from ..long_work import OnInterrupt, check_interrupt, counted
from ..problems.abilities import notation_of
from ..shared import files
from ..shared.on_demand import needed
from ..shared.row_journal import Rows
from . import pools
from .outcomes import ARGUMENTS, MADE, PLAIN, Outcome
from .plan import Plan, PlanError, planned
from .results import Survey
from .work import NOT_YET, Carrying, Family, Job, Row

if TYPE_CHECKING:
    from distributed import Client

MEANING = 3  # of rows: those of another number were found in another way, and are not taken over


def outcome_named(said: str, more: Mapping[str, Outcome] | None = None) -> Outcome:
    """The outcome that a name stands for.

    Raises
    ------
    PlanError
        If there is none.
    """
    known = {**PLAIN, **(more or {})}
    if said in known:
        return known[said]
    kind, _, argument = said.partition(":")
    if kind == "first" and argument and argument not in BY_NAME:
        raise PlanError(
            f"[survey] outcomes: {said!r}: there are no points of this kind{did_you_mean(argument, BY_NAME)}; known are {', '.join(BY_NAME)}"
        )
    if kind in MADE and argument:
        return partial(MADE[kind], **{ARGUMENTS[kind]: argument})
    forms = [f"{name}:..." for name in MADE]
    raise PlanError(f"[survey] outcomes: {said!r} is unknown; choose among {', '.join([*known, *forms])}")


@hinting
def survey(
    family: Family,
    vary: Plan | Mapping[str, object],
    *,
    over: str,
    within: tuple[float, float],
    outcomes: Sequence[str | Outcome] = ("peak",),
    gaps: int = 5,
    values: int = 0,
    starts: int = 1,
    atlas: Mapping[str, object] | None = None,
    swept: int = 0,
    workers: int | None = None,
    cluster: str | Client | None = None,
    journal: str | Path | Rows | None = None,
    units: Mapping[str, str] | None = None,
    about: Mapping[str, object] | None = None,
    progress: Callable[[Row], None] | bool | None = None,
    interrupt: OnInterrupt = "raise",
    **options: object,
) -> Survey:
    """A diagram of each of many systems.

    Parameters
    ----------
    family : callable
        ``family(values, near)``, what a diagram of the system with these values begins with; with members ``near(seed)``, what its
        neighbours may begin with, and ``starts(values, neighbours)``, all of those in order (see `orbits.design.Family`).
    vary : Plan or mapping
        Which systems; see `planned`.
    over, within
        The parameter of the diagrams and its interval.
    outcomes : sequence of str or callable
        Names (`contvines.survey.outcomes`), or functions ``(found: Findings) -> {column: number}``.
    gaps, values, starts : int
        Where the systems are simulated besides; see `contvines.survey.work.Job`.
    atlas : mapping, optional
        ``values``, ``starts``, ``seed``, ``scan``, ``budget`` of `contvines.atlas`: an atlas of each system in place of a diagram.
    swept : int
        At so many values each system is simulated in place of a diagram; the outcomes are ``peak`` and ``lower_peak``.
    workers : int, optional
        Processes of this machine; all cores by default, 1 for none beside this one.
    cluster : str or distributed.Client, optional
        A dask cluster instead.
    journal : path, optional
        Where rows are kept at once: the same survey goes on from them.
    units : mapping, optional
        Of parameters and outcomes.
    about : mapping, optional
        What is surveyed, JSON-able; it is kept with the results and decides whether a journal's rows are of the same survey.
    progress : callable or bool, optional
        Called with each row. By default a count on a terminal or in a notebook; False for none.
    interrupt : "raise" or "return"
        What Ctrl-C does: raise `contvines.Interrupted`, whose ``graph`` is the survey of the systems that are done, or return that survey.
        ``contvines.resume(survey)`` goes on.
    **options
        Of `contvines.diagram`, ``depth`` for example.

    Returns
    -------
    Survey

    Raises
    ------
    PlanError
        If it cannot be; a system that fails is a row with a sentence.
    Interrupted
        On Ctrl-C.
    """
    check_interrupt(interrupt)
    plan = vary if isinstance(vary, Plan) else planned(vary)
    functions = tuple(outcome_named(o) if isinstance(o, str) else o for o in outcomes)
    interval = (float(within[0]), float(within[1]))
    job = Job(family, over, interval, functions, gaps, values, starts, options, atlas, swept)
    systems = plan.systems()
    description = _description(plan, over, job.within, about)
    digest = digest_of(plan, over, job.within, about)
    if cluster is not None:
        needed("distributed", "surveys")
    kept = (
        journal
        if isinstance(journal, Rows)
        else Rows(Path(journal) if journal else None, {"contvines": "unfinished survey", "of": digest}, Row)
    )
    with kept as rows, counted(len(systems), "systems", progress) as tell:
        known = {row.index for row in rows.found}
        near: Sequence[object] = [None] * len(systems)
        if isinstance(family, Carrying) and not swept:
            near = family.starts(systems, plan.neighbours())
        tasks = [(i, values, near[i]) for i, values in enumerate(systems) if i not in known]
        stopped = False
        try:
            with closing(pools.worked(job, tasks, workers, cluster)) as worked:
                for row in worked:
                    rows.keep(row)
                    if tell is not None:
                        tell(row)
        except KeyboardInterrupt:
            stopped = True
        known = {row.index: row for row in rows.found}
        found = [known.get(i) or Row(i, {}, NOT_YET) for i in range(len(systems))]
    result = Survey.of(plan, found, dict(units or {}), {**description, "digest": digest}, notation_of(family))
    if stopped:
        again = partial(
            survey, family, plan, over=over, within=within, outcomes=outcomes, gaps=gaps, values=values, starts=starts, atlas=atlas, swept=swept,
            workers=workers, cluster=cluster, journal=kept, units=units, about=about, progress=progress, interrupt=interrupt, **options,
        )  # fmt: skip
        unfinished(result, again)
        if interrupt == "raise":
            raise Interrupted(result)
    return result


def digest_of(plan: Plan, over: str, within: tuple[float, float], about: Mapping[str, object] | None) -> str:
    """What decides a survey's rows: surveys that must give the same share it."""
    return files.digest_of({"rows": MEANING, **_description(plan, over, within, about)})


def _description(
    plan: Plan, over: str, within: tuple[float, float], about: Mapping[str, object] | None
) -> dict[str, Any]:
    return {
        "survey": dict(about or {}),
        "over": over,
        "within": [float(within[0]), float(within[1])],
        "axes": {name: values.tolist() for name, values in plan.axes.items()},
        "samples": {name: values.tolist() for name, values in plan.samples.items()},
    }
