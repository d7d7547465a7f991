"""The automatic diagram: trace branches, switch at special points and cross borders, until nothing new is found."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import checked
from ..continuation.settings import Settings, hinting
from ..continuation.starts import check_interval, problem_and_start
from ..journal import Journal, NullJournal
from ..long_work import Asked, OnInterrupt, Tell, carried_out
from ..problems.registry import without_problem
from . import Graph
from .builder import adopt, begin, finish, work
from .run import NO_LIMITS, Limits, Progress, Run
from .schedule_branches import leave, why_nothing_leaves


@hinting
def diagram(
    seed: object,
    over: str | None = None,
    within: tuple[float, float] | None = None,
    depth: int = 3,
    virtual: bool = False,
    user_functions: Mapping[str, Any] | None = None,
    journal: Journal | None = None,
    progress: Asked = None,
    settings: Settings | Mapping[str, Any] | None = None,
    stop: Mapping[str, Any] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    kinds: Sequence[Kind] | None = None,
    interrupt: OnInterrupt = "raise",
) -> Graph:
    """Compute all branches that are connected to a solution; each is listed once.

    Parameters
    ----------
    seed : orbit, SpecialPoint or Problem
        The start: an object with ``problem(parameter)`` and ``seed(problem) -> (u, p)``, a special point of another graph or of a locus, or a problem
        with ``u0`` and ``p0``.
    over : str, optional
        Name of the continuation parameter; not needed for a problem with its own, or with only one parameter.
    within : (float, float)
        Interval of the parameter.
    depth : int
        Largest number of switches between the first branch and any other. Crossing a border where the branch continues with another word is no switch.
    virtual : bool
        Follow branches beyond a border, too (marked real=False).
    user_functions : mapping, optional
        name -> callable (u, p) -> float, or (measure, value); their zeros become special points of kind "user".
    journal : Journal, optional
        Store of results; recorded ones are not computed again. See :class:`contvines.MemoryJournal`.
    progress : callable or bool, optional
        Called with a ``Progress`` (``message`` and counts) after each chunk and each branch. By default a line on a terminal or in a notebook;
        False for none.
    settings : Settings or mapping, optional
    stop : mapping, optional
        Like ``user_functions``; branches end at their zeros.
    bounds : mapping, optional
        name of a measure (``"u0"``, ``"norm"``, a user-defined output) -> (low, high), either may be None; branches end at these values.
    kinds : sequence of Kind, optional
        Kinds of special points to find: ``[*contvines.KINDS, yours]``; by default the built-in kinds.
    interrupt : "raise" or "return"
        Effect of Ctrl-C: raise :class:`contvines.Interrupted`, whose ``graph`` has all results so far, or return that graph.
        ``contvines.resume(graph)`` continues.

    Returns
    -------
    Graph

    Raises
    ------
    ValueError
        If the interval, a setting, a kind or the start is invalid; the message gives the reason.
    Interrupted
        On Ctrl-C.
    """
    problem, u, p = problem_and_start(seed, over)
    if within is None:
        raise ValueError(
            f"within = None: give the interval of {problem.parameter}, for example within=(0.2, 1.3)"
        )
    description = problem.describe()
    model = description.get("model") or {"name": description.get("name", type(problem).__name__)}
    model_data = dict(model) if isinstance(model, Mapping) else {"name": model}
    limits = Limits.of(stop, bounds, problem)

    def start(stored: Journal, report: Tell | None) -> tuple[Graph, Callable[[], None]]:
        run = new_run(
            problem.parameter,
            model_data,
            within,
            depth,
            virtual,
            user_functions,
            stored,
            report,
            settings,
            limits,
            kinds,
        )

        def carry_on() -> None:
            begin(run, problem, u, p)
            work(run)
            finish(run)
            for kind in kinds or ():
                if (
                    kind.test is not None
                    and not run.graph.of_kind(kind.name)
                    and not _ever_a_number(run, kind)
                ):
                    warnings.warn(
                        f"kind {kind.name}: its test is not a finite number on any branch, so that no point is found",
                        UserWarning,
                        stacklevel=5,
                    )

        return run.graph, carry_on

    return carried_out(start, journal, progress, interrupt)


def _ever_a_number(run: Run, kind: Kind) -> bool:
    """Whether a user-defined test is a finite number in the middle of any branch."""
    for branch in run.graph.branches.values():
        detector = run.detector(branch.attached)
        i = len(branch) // 2
        point = detector.engine.at_value(branch.points[i], float(branch.values[i]))
        test = next(own for own in detector.own if own.kind is kind)
        if point is not None and np.isfinite(test.at(point)):
            return True
    return False


def new_run(
    parameter: str,
    model: dict[str, Any],
    within: tuple[float, float],
    depth: int,
    virtual: bool,
    user_functions: Mapping[str, Any] | None,
    journal: Journal,
    progress: Callable[[Progress], None] | None,
    settings: Settings | Mapping[str, Any] | None,
    limits: Limits = NO_LIMITS,
    kinds: Sequence[Kind] | None = None,
) -> Run:
    """Return a run with an empty graph; parameters as for :func:`diagram`.

    Raises
    ------
    ValueError
        If the interval, the depth or a setting is invalid.
    """
    if not (isinstance(depth, int) and depth >= 0):
        raise ValueError(f"depth = {depth!r} must be a whole number, 0 or more")
    chosen, looked_for = Settings.of(settings), checked(kinds)
    described = [kind.look() for kind in looked_for if kind.test is not None]
    graph = Graph(
        parameter=parameter,
        model=model,
        within=check_interval(within),
        settings={
            **chosen.to_dict(),
            "depth": depth,
            "virtual": virtual,
            **({"kinds": described} if described else {}),
            **limits.kept(),
        },
    )
    stored = NullJournal() if journal is None else journal
    return Run(graph, chosen, stored, depth, virtual, user_functions, progress, limits, looked_for)


@hinting
def switch(
    graph: Graph,
    label: str,
    depth: int = 0,
    user_functions: Mapping[str, Any] | None = None,
    journal: Journal | None = None,
    progress: Callable[[Progress], None] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
    stop: Mapping[str, Any] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    kinds: Sequence[Kind] | None = None,
) -> list[str]:
    """Follow the branches that leave a special point of a graph; the graph is extended in place.

    Parameters
    ----------
    graph : Graph
    label : str
        Label of a special point; its problem must be attached.
    depth : int
        Largest number of further switches from the new branches.
    user_functions, journal, progress, settings, stop, bounds, kinds
        As for :func:`diagram`; the settings and bounds of the graph are the default.

    Returns
    -------
    list of str
        Labels of the new branches. Empty if no branch leaves or all are known already; a warning gives the reason.

    Raises
    ------
    TypeError
        If `label` is no text.
    KeyError
        If the graph has no such special point.
    ValueError
        If the special point has no problem.
    """
    if not isinstance(label, str):
        name = getattr(label, "label", None)
        hint = f"{name!r}, the label of this {type(label).__name__}" if name else "'SB1'"
        raise TypeError(f"switch needs the label of a special point as text, for example {hint}")
    if label not in graph.special:
        labels = ", ".join(graph.special) or "none"
        raise KeyError(f"the graph has no special point {label!r}; it has {labels}")
    point = graph.special[label]
    if point.problem is None:
        raise ValueError(without_problem(label, graph.branches[point.branch].description))
    before, finished = list(graph.branches), graph.finished
    run = Run(
        graph,
        Settings.kept(graph.settings) if settings is None else Settings.of(settings),
        NullJournal() if journal is None else journal,
        depth + 1,
        bool(graph.settings.get("virtual", False)),
        user_functions,
        progress,
        Limits.of(stop, graph.settings.get("bounds") if bounds is None else bounds, point.problem),
        checked(kinds),
    )
    adopt(run)
    leave(run, point, graph.branches[point.branch], depth=0)
    work(run)
    if finished:  # an unfinished graph stays unfinished
        finish(run)
    new = [name for name in graph.branches if name not in before]
    if not new:
        warnings.warn(f"{label}: {why_nothing_leaves(graph, label)}", UserWarning, stacklevel=3)
    return new


__all__ = ["Progress", "diagram", "problem_and_start", "switch"]
