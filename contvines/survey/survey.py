"""The function `survey`: compute diagrams of many systems and their outcomes."""

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
from ..long_work import HELD, OnInterrupt, check_interrupt, counted
from ..problems.abilities import notation_of
from ..shared import files
from ..shared.on_demand import needed
from ..shared.row_journal import Rows
from . import pools
from .outcomes import ARGUMENTS, PLAIN, WITH_ARGUMENT, Outcome
from .plan import Plan, PlanError, planned
from .results import Survey
from .work import NOT_YET, Carrying, Family, Job, Row

if TYPE_CHECKING:
    from distributed import Client

MEANING = 3  # version of the meaning of rows; rows of a journal with another version are not reused


def outcome_named(wanted: str, more: Mapping[str, Outcome] | None = None) -> Outcome:
    """Return the outcome function with a name, such as ``peak`` or ``stable:LR``.

    Parameters
    ----------
    wanted : str
        The name.
    more : mapping, optional
        Further outcomes by name, besides `contvines.survey.outcomes.PLAIN`.

    Raises
    ------
    PlanError
        If there is no such outcome.
    """
    functions = {**PLAIN, **(more or {})}
    if wanted in functions:
        return functions[wanted]
    kind, _, argument = wanted.partition(":")
    if kind == "first" and argument and argument not in BY_NAME:
        raise PlanError(
            f"[survey] outcomes: {wanted!r}: there are no points of this kind{did_you_mean(argument, BY_NAME)}; known are {', '.join(BY_NAME)}"
        )
    if kind in WITH_ARGUMENT and argument:
        return partial(WITH_ARGUMENT[kind], **{ARGUMENTS[kind]: argument})
    forms = [f"{name}:..." for name in WITH_ARGUMENT]
    raise PlanError(
        f"[survey] outcomes: {wanted!r} is unknown; choose among {', '.join([*functions, *forms])}"
    )


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
    """Compute a diagram of each of many systems, and numbers (outcomes) from each diagram.

    Parameters
    ----------
    family : callable
        ``family(values, near)`` returns the seed of the diagram of the system with these parameter values. Optional methods:
        ``near(seed)`` returns a start for the system's neighbours, and ``starts(values, neighbours)`` the starts of all systems in
        order (see `orbits.design.Family`).
    vary : Plan or mapping
        The systems; see `planned`.
    over, within
        The parameter of the diagrams and its interval.
    outcomes : sequence of str or callable
        Names (see `contvines.survey.outcomes`), or functions ``(found: Findings) -> {column: number}``.
    gaps, values, starts : int
        Numbers of additional simulations; see `contvines.survey.work.Job`.
    atlas : mapping, optional
        Compute an atlas of each system instead of a diagram, with these arguments of `contvines.atlas`: ``values``, ``starts``,
        ``seed``, ``scan``, ``budget``.
    swept : int
        Simulate each system at this number of values instead of computing a diagram; the outcomes are then ``peak`` and ``lower_peak``.
    workers : int, optional
        Number of processes on this computer; by default one per core. 1: this process only.
    cluster : str or distributed.Client, optional
        A dask cluster instead.
    journal : path, optional
        File in which each row is stored at once; the same survey resumes from it.
    units : mapping, optional
        Units of parameters and outcomes.
    about : mapping, optional
        Description of the family, JSON-able. It is stored with the results; rows of a journal are reused only if it is equal.
    progress : callable or bool, optional
        Called with each row. By default a count is shown on a terminal or in a notebook; False: nothing.
    interrupt : "raise" or "return"
        Effect of Ctrl-C: raise `contvines.Interrupted`, whose ``graph`` is the survey of the finished systems, or return that survey.
        ``contvines.resume(survey)`` continues.
    **options
        Further arguments of `contvines.diagram`, for example ``depth``.

    Returns
    -------
    Survey

    Raises
    ------
    PlanError
        If the survey is invalid. A system that fails raises nothing: its row gives the reason in `note`.
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
    row_file = (
        journal
        if isinstance(journal, Rows)
        else Rows(Path(journal) if journal else None, {"contvines": "unfinished survey", "of": digest}, Row)
    )
    with row_file as rows, counted(len(systems), "systems", progress) as tell:
        done = {row.index for row in rows.found}
        near: Sequence[object] = [None] * len(systems)
        if isinstance(family, Carrying) and not swept:
            near = family.starts(systems, plan.neighbours())
        tasks = [(i, values, near[i]) for i, values in enumerate(systems) if i not in done]
        stopped = False
        try:
            with closing(pools.worked(job, tasks, workers, cluster)) as worked:
                for row in worked:
                    with HELD:
                        rows.keep(row)
                    if tell is not None:
                        tell(row)
        except KeyboardInterrupt:
            stopped = True
        done = {row.index: row for row in rows.found}
        found = [done.get(i) or Row(i, {}, NOT_YET) for i in range(len(systems))]
    result = Survey.of(plan, found, dict(units or {}), {**description, "digest": digest}, notation_of(family))
    if stopped:
        rerun = partial(
            survey, family, plan, over=over, within=within, outcomes=outcomes, gaps=gaps, values=values, starts=starts, atlas=atlas, swept=swept,
            workers=workers, cluster=cluster, journal=row_file, units=units, about=about, progress=progress, interrupt=interrupt, **options,
        )  # fmt: skip
        unfinished(result, rerun)
        if interrupt == "raise":
            raise Interrupted(result)
    return result


def digest_of(plan: Plan, over: str, within: tuple[float, float], about: Mapping[str, object] | None) -> str:
    """Return the digest of everything that determines a survey's rows; equal surveys have equal digests."""
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
