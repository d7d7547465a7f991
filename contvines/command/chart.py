"""`contvines chart`: all special points of a diagram followed in a second parameter."""

from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.amounts import interval
from contvines.command.options import FreshOption, TrustOption
from contvines.command.place import held
from contvines.command.plane import PlotOption, QuietOption, VirtualOption, check, refuse_charts, tell
from contvines.command.stored import finished_of, refuse_detached


def chart(
    file: Annotated[
        Path,
        typer.Argument(metavar="STUDY.toml|FILE.vines", help="A study, or a diagram that was made of one."),
    ],
    over: Annotated[
        str | None,
        typer.Option("--over", metavar="NAME", help="The second parameter; by default [chart] parameter."),
    ] = None,
    within: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--within",
            metavar="LOW HIGH",
            help="Its interval, numbers or quantities as '0.1 mm' '0.6 mm'; by default [chart] within.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE.vines", help="Where to keep it; by default NAME-chart.vines here."
        ),
    ] = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    virtual: VirtualOption = False,
    quiet: QuietOption = False,
    trust: TrustOption = False,
) -> None:
    """Chart two parameters: loci from all special points, what they meet, regions; goes on when interrupted."""
    from contvines.command.compose import beside, check_place

    target = output or beside(file, "-chart.vines")
    check_place(target)
    check(plot, target, file)
    graph, over, ends = _diagram(file, over, within, trust, fresh)
    refuse_detached(
        graph,
        (label for label, point in graph.special.items() if point.kind not in ("end", "user")),
    )
    with held(target, quiet, fresh):
        found = _chart(graph, over, ends, virtual, target, quiet)
    tell(found, target, plot, quiet)


def _chart(graph: Any, over: str, ends: tuple[float, float], virtual: bool, target: Path, quiet: bool) -> Any:
    """The chart of a diagram: from its file if that is finished, computed else."""
    from contvines.command.compose import say
    from contvines.command.run import interruptible
    from contvines.loci.charting import chart as make
    from contvines.progress import shown
    from contvines.store import Store

    fingerprint = _fingerprint(graph, over, ends, virtual)
    found = finished_of(target, fingerprint, quiet, problems=False)
    if found is not None:
        say(f"{target} holds the finished chart; nothing to compute.", quiet)
        return found
    note = f"all finished points are kept in {target}; the same command goes on from there"
    with Store.attach(target, fingerprint, {"chart": [over, *ends]}) as store:
        with interruptible(note), shown(not quiet) as progress:
            found = make(graph, over, ends, virtual=virtual, journal=store, progress=progress)
        store.tidy()
    return found


def _diagram(
    file: Path, over: str | None, within: tuple[str, str] | None, trust: bool, fresh: bool
) -> tuple[Any, str, tuple[float, float]]:
    """The diagram to chart, made first if a study is given, and what to chart it over."""
    from contvines.command.study import is_database
    from contvines.store import load

    if is_database(file):
        graph = load(file, trust=trust)
        refuse_charts(graph, file)
        if not graph.finished:
            raise ValueError(f"{file}: this file is unfinished; run the command that made it again first.")
        if over is None or within is None:
            missing = "--over" if over is None else "--within"
            raise ValueError(f"{missing} is missing: for example --over friction --within 0 0.8 would do.")
        return graph, over, interval("--within", within, over, graph.units)
    from contvines.command.compose import beside, checked_study
    from contvines.command.run import diagram

    study = checked_study(file)
    said = None
    if study.chart is not None:
        over = over or study.chart.parameter
        said = (study.chart.within[0], study.chart.within[1])
    if over is None or (within is None and said is None):
        raise ValueError(
            f"{file}: name the second parameter and its interval: --over friction --within 0 0.8, or a section [chart] with "
            "parameter and within."
        )
    diagram(file, quiet=True, fresh=fresh)
    graph = load(beside(file, ".vines"))
    ends = said if within is None else interval("--within", within, over, graph.units)
    assert ends is not None
    return graph, over, ends


def _fingerprint(graph: Any, over: str, within: tuple[float, float], virtual: bool) -> str:
    import hashlib
    import json

    values = [(point.label, point.kind, point.value) for point in graph.special.values()]
    text = json.dumps(
        ["chart", graph.model, graph.parameter, list(graph.within), values, over, list(within), virtual]
    )
    return hashlib.sha256(text.encode()).hexdigest()
