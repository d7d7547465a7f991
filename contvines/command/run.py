"""`contvines diagram`, `trace` and `switch`: the commands that continue."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.compare import CompareOption, check_compared
from contvines.command.options import FreshOption, TrustOption
from contvines.command.place import held

StudyArgument = Annotated[
    Path, typer.Argument(metavar="STUDY.toml", help="The study: model, start, what to continue.")
]
FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE.vines", help="A file that diagram or trace has made.")
]
OutputOption = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", metavar="FILE.vines", help="Where to keep the graph; by default STUDY.vines here."
    ),
]
TraceOutputOption = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE.vines",
        help="Where to keep the branch; by default STUDY-trace.vines here.",
    ),
]
AtlasOutputOption = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        metavar="FILE.vines",
        help="Where to keep the graph; by default STUDY-atlas.vines here.",
    ),
]
PlotOption = Annotated[
    Path | None,
    typer.Option("--plot", metavar="FILE.png", help="Draw the bifurcation diagram (png, pdf or svg)."),
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table.")]
XOption = Annotated[str | None, typer.Option("-x", help="Measure on the x axis; by default the parameter.")]
YOption = Annotated[
    str | None,
    typer.Option(
        "-y",
        help="Measure on the y axis; by default B, max_abs_q1 of the coupled machine, the first measure of other problems (FILE --help names it).",
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
        typer.Option(
            "--look/--no-look",
            help="At the end, simulate a few starts and say in one line what they reach that is on no branch.",
        ),
    ] = True,
    compare: CompareOption = None,
) -> None:
    """Automatic bifurcation diagram of a study; goes on with an unfinished file."""
    _run("diagram", study, output, plot, fresh, quiet, x, y, compare, look)


def atlas(
    study: StudyArgument,
    output: AtlasOutputOption = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
    x: XOption = None,
    y: YOption = None,
) -> None:
    """Everything that coexists: many simulated starts, and branches through all they reach.

    [atlas] in the study says at how many values (or which), from how many
    starts at each, drawn with which seed, and how many further values in a
    row must meet nothing new. An interrupted run goes on.
    """
    _run("atlas", study, output, plot, fresh, quiet, x, y)


def trace(
    study: StudyArgument,
    output: TraceOutputOption = None,
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
    label: Annotated[str, typer.Argument(metavar="LABEL", help="A special point, for example SB1.")],
    quiet: QuietOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow the branch that leaves a special point, and add it to the file."""
    from contvines.graph.schedule_branches import why_nothing_leaves

    with held(file, quiet):
        graph, new = _switched(file, label, quiet, trust)
    if not quiet:
        if not new:
            typer.echo(f"{label}: {why_nothing_leaves(graph, label)}; {file} is as it was.")
        for branch in new:
            low, high = branch.range
            typer.echo(
                f"{branch.label}: {len(branch)} points, {branch.parameter} from {low:.6g} to {high:.6g}"
            )


def _switched(file: Path, label: str, quiet: bool, trust: bool) -> tuple[Any, list[Any]]:
    """The graph of a file with what leaves a special point, and the branches that are new."""
    from contvines.continuation.settings import Settings
    from contvines.graph.automatic import switch as leave
    from contvines.progress import shown
    from contvines.store import Store, load

    graph = load(file, trust=trust)
    if not graph.finished:
        raise ValueError(f"{file}: this file is unfinished; run the command that made it again first.")
    if label not in graph.special:
        what = "is a branch" if label in graph.branches else "is no label of it"
        raise ValueError(
            f"{file}: {label} {what}; its special points are {', '.join(graph.special) or 'none'}."
        )
    own = Settings().to_dict()
    settings = {
        k: v for k, v in graph.settings.items() if k in own and k != "max_branches"
    }  # trace allows one only
    with (
        interruptible(f"{file} is as it was"),
        shown(not quiet) as progress,
        warnings.catch_warnings(action="ignore", category=UserWarning),  # the caller prints the reason
    ):
        new = [graph.branches[name] for name in leave(graph, label, progress=progress, settings=settings)]
    if new:
        with Store.open(file, write=True) as store:
            store.checkpoint(graph)
            store.tidy()
    return graph, new


def _run(
    command: str,
    path: Path,
    output: Path | None,
    plot: Path | None,
    fresh: bool,
    quiet: bool,
    x: str | None,
    y: str | None,
    compare: list[str] | None = None,
    look: bool = False,
) -> None:
    from contvines.command.compose import (
        beside,
        check_place,
        check_shaken,
        checked_study,
        machine,
        say,
    )
    from contvines.command.measures import check_axes, check_bounds

    study = checked_study(path)
    check_axes(study, {"-x": x, "-y": y}, plot)
    check_bounds(study, command)
    check_shaken(study)
    check_compared(compare, plot is not None)
    target = output or beside(path, ".vines" if command == "diagram" else f"-{command}.vines")
    check_place(target)
    if target.resolve() == path.resolve():
        raise ValueError(f"{target}: this is the study itself; choose another name with -o.")
    if plot is not None:
        _check_picture(plot)
    with held(target, quiet, fresh):
        graph = _graph(study, command, target, quiet, problems=plot is not None, look=look)
    if not quiet:
        typer.echo(str(graph))
    if compare and not quiet:
        from contvines.command.compare import told_compared
        from contvines.text_table import fitted

        typer.echo("\n" + fitted(told_compared(machine(study), study.parameter, study.within, compare)))
    if command == "diagram" and graph.missing:
        from contvines.coexistence.missing import told

        say(told(graph, f"contvines atlas {path} adds what is connected to it"), quiet)
    if plot is not None:
        _draw(graph, x, y, plot, compare)
        say(f"drawn in {plot}", quiet)


def _graph(study: Any, command: str, target: Path, quiet: bool, *, problems: bool, look: bool) -> Any:
    """The graph of a study: from its file if that is finished, computed else."""
    from contvines.command.compose import first_orbit, population, run_atlas, run_diagram, say
    from contvines.command.stored import finished_of
    from contvines.progress import shown
    from contvines.store import Store

    fingerprint = study.fingerprint(command)
    graph = finished_of(target, fingerprint, quiet, problems=problems)
    if graph is None:
        alone = {"depth": 0, "settings": {**study.settings, "max_branches": 1}} if command == "trace" else {}
        run = run_atlas if command == "atlas" else run_diagram
        seed = population(study) if command == "atlas" else first_orbit(study)
        with Store.attach(target, fingerprint, study.describe()) as store:
            note = f"all finished points are kept in {target}; the same command goes on from there"
            with interruptible(note), shown(not quiet) as progress:
                graph = run(study, seed, journal=store, progress=progress, **alone)
            store.tidy()
        say(f"kept in {target}", quiet)
    elif graph.looked or not look:
        say(f"{target} holds the finished result of this study; nothing to compute.", quiet)
    return _look(study, target) if look and not graph.looked else graph


@contextmanager
def interruptible(note: str) -> Iterator[None]:
    """Ctrl-C ends the command with a sentence that says what is kept and how to go on."""
    from contvines.command.compose import Interrupted

    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(note) from None


def _check_picture(path: Path) -> None:
    # kept apart from matplotlib: a wrong name is refused at once
    from contvines.plots.figures import check_picture

    check_picture(path)


def _look(study: Any, target: Path) -> Any:
    """A few simulated starts after a diagram; what they reach beside it is kept in the file.

    The graph is read from its file, so that a run killed in the look ends with the graph of an undisturbed one.
    """
    from contvines.coexistence.missing import look
    from contvines.command.compose import population
    from contvines.store import Store

    with Store.open(target, write=True) as store:
        graph = store.graph()
        with interruptible(
            f"the diagram is kept in {target}; the same command looks again for what it does not have"
        ):
            look(graph, population(study))
        store.checkpoint(graph)
        store.tidy()
    return graph


def _draw(graph: Any, x: str | None, y: str | None, path: Path, compare: list[str] | None = None) -> None:
    from contvines.plots.figures import save_figure

    if graph.attractors:
        from contvines.plots.atlas import plot_atlas

        save_figure(plot_atlas(graph, x, y), path)
        return
    from contvines.command.compare import compared

    save_figure(compared(graph, compare, x, y), path)
