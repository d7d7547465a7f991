"""`contvines diagram`, `trace`, `atlas` and `switch`: the commands for continuation."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .frame import (
    check_special,
    draw,
    finished_of,
    held,
    interruptible,
    load_file,
    made,
    place_of,
    refuse_unfinished,
    say,
    tell_result,
    working,
)
from .options import (
    CompareOption,
    DetailsOption,
    FileArgument,
    FreshOption,
    LabelArgument,
    PlotOption,
    QuietOption,
    StudyArgument,
    TrustOption,
    XOption,
    YOption,
    option,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph import Graph
    from .study_data import Study

SIMULATED = "#2f6f3e"
OutputOption = Annotated[
    Path | None,
    option(
        "-o, --output FILE.vines",
        "Result file; by default STUDY.vines (diagram) or STUDY-COMMAND.vines in this folder.",
    ),
]


def diagram(
    study: StudyArgument,
    output: OutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
    x: XOption = None,
    y: YOption = None,
    look: Annotated[
        bool,
        option(
            "--look/--no-look",
            "At the end, simulate a few starts and list the motions they reach that are on no branch.",
        ),
    ] = True,
    compare: CompareOption = None,
    details: DetailsOption = False,
) -> None:
    """Automatic bifurcation diagram of a study; an interrupted run goes on."""
    _run("diagram", study, output, plot, fresh, quiet, x, y, compare, look, details)


def atlas(
    study: StudyArgument,
    output: OutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
    x: XOption = None,
    y: YOption = None,
    details: DetailsOption = False,
    budget: Annotated[
        int | None,
        option(
            "--budget N",
            "Work that it may take, in place of [atlas] budget. A larger one goes on from what was computed.",
            min=1,
        ),
    ] = None,
) -> None:
    """All coexisting motions: many starts are simulated, and all that they reach is continued.

    [atlas] in the study sets the values of the parameter, the number of
    starts at each, their seed, after how many further values without a
    new motion the search ends, and how much work it may take. An interrupted
    run goes on, and one that has used up its budget does with a larger one.
    """
    _run("atlas", study, output, plot, fresh, quiet, x, y, details=details, budget=budget)


def trace(
    study: StudyArgument,
    output: OutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
    x: XOption = None,
    y: YOption = None,
) -> None:
    """Follow the study's one branch, without switching."""
    _run("trace", study, output, plot, fresh, quiet, x, y)


def switch(
    file: FileArgument,
    label: LabelArgument,
    quiet: QuietOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow the branch that leaves a special point, and add it to the file."""
    from ..continuation.settings import Settings
    from ..graph.automatic import switch as leave
    from ..graph.schedule_branches import why_nothing_leaves
    from ..store import Store

    with held(file, quiet):
        graph = load_file(file, trust)
        refuse_unfinished(graph, file)
        check_special(graph, file, label)
        own = (
            Settings().to_dict()
        )  # without max_branches below, as a file from `trace` allows one branch only
        settings = {k: v for k, v in graph.settings.items() if k in own and k != "max_branches"}
        with (
            working(f"{file} is as it was", quiet) as progress,
            warnings.catch_warnings(action="ignore", category=UserWarning),  # the reason is printed below
        ):
            new = [graph.branches[name] for name in leave(graph, label, progress=progress, settings=settings)]
        if new:
            with Store.open(file, write=True) as store:
                store.checkpoint(graph)
                store.tidy()
    if not quiet:
        if not new:
            typer.echo(f"{label}: {why_nothing_leaves(graph, label)}; {file} is as it was.")
        for branch in new:
            low, high = branch.range
            typer.echo(
                f"{branch.label}: {len(branch)} points, {branch.parameter} from {low:.6g} to {high:.6g}"
            )


def _run(
    command: str,
    path: Path,
    output: Path | None,
    plot: Path | None,
    fresh: bool,
    quiet: bool,
    x: str | None,
    y: str | None,
    compare: Sequence[str] | None = None,
    look: bool = False,
    details: bool = False,
    budget: int | None = None,
) -> None:
    from .compose import check_axes, check_bounds, check_shaken
    from .study import read_study

    study = read_study(path)
    if budget is not None:
        study = study.having("atlas", budget=budget)
    check_axes(study, {"-x": x, "-y": y}, plot)
    check_bounds(study, command)
    check_shaken(study)
    if compare and plot is None:
        raise ValueError(
            f"--compare {compare[0]}: there is no picture to show it in; give --plot FILE.png, too."
        )
    target = place_of(output, path, ".vines" if command == "diagram" else f"-{command}.vines")
    with held(target, quiet, fresh):
        problems = plot is not None or (command == "diagram" and not quiet)  # measures need them
        graph = graph_of(study, command, target, quiet, problems=problems, look=look)
    if not quiet:
        tell_result(graph, target, details) if command != "trace" else typer.echo(str(graph))
    if graph.stopped:
        more = 2 * graph.settings["budget"]
        say(f"contvines atlas {path} --budget {more} goes on from what is kept in {target}", quiet)
    if compare and not quiet:
        from ..text_table import fitted
        from .plot import compared_text

        typer.echo("\n" + fitted(compared_text(study.model, study.parameter, study.within, compare)))
    if command == "diagram" and graph.missing:
        from ..coexistence.census import missing_text

        say(missing_text(graph, str(path)), quiet)
    draw(plot, lambda: _picture(graph, x, y, compare, study), quiet)


def graph_of(study: Study, command: str, target: Path, quiet: bool, *, problems: bool, look: bool) -> Graph:
    """Return the graph of a study, from its file if that is finished, otherwise computed."""
    from ..graph import Graph
    from .compose import first_orbit, population, run_atlas, run_diagram

    fingerprint = study.fingerprint(command)
    graph = finished_of(Graph, target, fingerprint, quiet, problems=problems)
    if graph is not None and graph.stopped:
        from ..coexistence.effort import BUDGET

        budget = study.atlas.budget or BUDGET
        if budget > graph.settings["budget"]:
            say(f"{target} was stopped at budget = {graph.settings['budget']}: going on to {budget}.", quiet)
            graph = None
    if graph is None:
        extra = {"depth": 0, "settings": {**study.settings, "max_branches": 1}} if command == "trace" else {}
        run, start = (run_atlas, population) if command == "atlas" else (run_diagram, first_orbit)
        seed = start(study)
        graph = made(
            target,
            fingerprint,
            study.kept(command, target),
            quiet,
            lambda **to: run(study, seed, **to, **extra),
        )
        say(f"kept in {target}", quiet)
    elif not look or graph.looked:
        say(f"{target} holds the finished result of this study; nothing to compute.", quiet)
    return _with_missing(study, target) if look and not graph.looked else graph


def _with_missing(study: Study, target: Path) -> Graph:
    """Run the brief search after a diagram, and store its result in the file; return the graph with the missing attractors.

    The graph is read from its file, so that the result does not depend on whether a run was killed during the search.
    """
    from ..coexistence.census import look
    from ..graph import Graph
    from ..store import Store
    from .compose import population

    with Store.open(target, write=True) as store:
        graph = store.graph()
        assert isinstance(graph, Graph)
        with interruptible(
            f"the diagram is kept in {target}; the same command looks again for what it does not have"
        ):
            try:
                look(graph, population(study))
            except ValueError as error:  # no start lies between the walls; the diagram stands
                say(f"what else may settle was not simulated: {error}", quiet=False)
        store.checkpoint(graph)
        store.tidy()
    return graph


def _picture(
    graph: Graph, x: str | None, y: str | None, compare: Sequence[str] | None, study: Study
) -> Figure:
    if graph.attractors:
        from ..plots.atlas import plot_atlas

        return plot_atlas(graph, x, y)
    if compare:
        from .plot import compared

        # in a comparison the responses matter, not the connections of branches
        figure = compared(graph, compare, x, y, marks=[], labels=False, color="stability")
    else:
        from ..plots.diagram import plot_diagram

        figure = plot_diagram(graph, x, y)
    if study.flow is None and graph.looked and x in (None, graph.parameter) and _shows_response(graph, y):
        _add_simulated(figure.axes[0], graph, study)
    return figure


def _shows_response(graph: Graph, y: str | None) -> bool:
    """Whether the picture shows a displacement, for which simulations give the band of modulated motions."""
    from ..graph.stretches import default_measure

    measure = default_measure(graph)
    return measure.startswith("max_") and y in (None, measure)


def _add_simulated(axes: Axes, graph: Graph, study: Study) -> None:
    """Draw simulated responses in the gaps of the diagram: dots, and bars over the range per forcing period for motions that do not recur."""
    from ..plots.legends import place_legend
    from ..plots.sweep import draw_bands
    from ..shared.figures import styled
    from ..survey.completion import simulated
    from .compose import population

    motions = simulated(graph, population(study))
    plain = [(value, high) for value, low, _, high in motions if low == high]
    if plain:
        axes.plot(*zip(*plain), ".", color=SIMULATED, zorder=1.6, label="simulated")
    draw_bands(axes, [band for band in motions if band[1] < band[3]], SIMULATED)
    if motions and axes.get_legend() is not None:
        with styled():
            place_legend(axes, (), "best", False)
