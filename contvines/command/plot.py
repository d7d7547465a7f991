"""`contvines plot`: pictures of a stored graph."""

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.compare import check_compared, compared
from contvines.command.frame import beside, load_file, say_state
from contvines.command.options import CompareOption, FileArgument, SizeOption, TrustOption, option, picture


class Picture(StrEnum):
    """What `plot` draws."""

    diagram = "diagram"
    multipliers = "multipliers"
    network = "network"


class Colors(StrEnum):
    """What a colour of a diagram stands for."""

    branch = "branch"
    word = "word"
    stability = "stability"


def plot(
    file: FileArgument,
    x: Annotated[str | None, option("-x", "Measure on the x axis; by default the parameter.")] = None,
    y: Annotated[
        str | None,
        option(
            "-y",
            "Measure on the y axis; by default B (velocity at the first impact) "
            "of the absorber, max_abs_q1 of the coupled machine, else the first measure of the problem.",
        ),
    ] = None,
    output: Annotated[Path | None, option("-o, --output FILE.png", "Picture: png, pdf or svg.")] = None,
    kind: Annotated[Picture, option("--kind", "What to draw.")] = Picture.diagram,
    compare: CompareOption = None,
    branch: Annotated[
        str | None, option("--branch", "With --kind multipliers: the branch; by default B1.")
    ] = None,
    xlim: Annotated[tuple[float, float] | None, option("--xlim LOW HIGH", "Limits of the x axis.")] = None,
    ylim: Annotated[tuple[float, float] | None, option("--ylim LOW HIGH", "Limits of the y axis.")] = None,
    size: SizeOption = None,
    color: Annotated[Colors | None, option("--color", "What the colours show.")] = None,
    marks: Annotated[
        str | None,
        option("--marks LP,SB,...", "Kinds of special points to mark, or none; by default all."),
    ] = None,
    words: Annotated[bool, option("--words", "Write the words beside the branches.")] = False,
    legend: Annotated[bool, option("--legend/--no-legend", "Legend of lines and marks.")] = True,
    inset: Annotated[
        bool | None,
        option(
            "--inset/--no-inset",
            "Enlarge the most crowded part in an inset; by default only where marks overlap.",
        ),
    ] = None,
    style: Annotated[
        str | None,
        option(
            "--style",
            "aps, elsevier, springer (one column), grey, slides, or a style of matplotlib; several as aps,grey.",
        ),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Draw a result: the diagram, the multipliers of a branch, or the network of branches."""
    from contvines.plots.figures import check_style, save_figure

    asked = {
        "-x": x,
        "-y": y,
        "--xlim": xlim,
        "--ylim": ylim,
        "--color": color,
        "--marks": marks,
        "--words": words or None,
    }
    asked |= {"--compare": compare[0] if compare else None}
    check_compared(compare, True)
    asked |= {"--no-inset" if inset is False else "--inset": None if inset is None else ""}
    asked |= {"--no-legend": None if legend else "", "--branch": branch}
    _refuse_ignored(kind, asked)
    target = output or beside(file, ".png")
    picture(target)
    check_style(style)
    for name, pair in (("--xlim", xlim), ("--ylim", ylim)):
        if pair is not None and not (math.isfinite(sum(pair)) and pair[0] < pair[1]):
            raise ValueError(
                f"{name} {pair[0]:g} {pair[1]:g}: give the lower number first, then the higher one."
            )
    from contvines.loci.chart import Chart

    graph = load_file(file, trust, charts=True)
    if isinstance(graph, Chart):
        from contvines.plots.chart import plot_chart

        _refuse_of_chart(file, kind, {name: value for name, value in asked.items() if name != "--no-legend"})
        save_figure(plot_chart(graph, figsize=size, style=style, legend=legend), target)
        typer.echo(str(target))
        return
    say_state(graph, file)
    if not graph.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    if kind is Picture.diagram:
        figure = compared(
            graph,
            compare,
            x,
            y,
            words=words,
            color=(color or Colors.branch).value,
            marks=True if marks is None else [] if marks == "none" else marks.split(","),
            legend=legend,
            xlim=xlim,
            ylim=ylim,
            inset=True if inset is None else inset,
            figsize=size,
            style=style,
        )
    elif kind is Picture.network:
        from contvines.plots.network import plot_network

        figure = plot_network(graph, figsize=size, style=style)
    else:
        from contvines.plots.multipliers import plot_multipliers

        label = branch or next(iter(graph.branches))
        if label not in graph.branches:
            raise ValueError(
                f"--branch {label}: there is no such branch in {file}; it has {', '.join(graph.branches)}."
            )
        figure = plot_multipliers(graph.branches[label], figsize=size, style=style)
    save_figure(figure, target)
    typer.echo(str(target))


def _refuse_of_chart(file: Path, kind: Picture, options: dict[str, Any]) -> None:
    """Options that the picture of a chart would ignore are refused."""
    for name, value in {**options, "--kind": None if kind is Picture.diagram else kind.value}.items():
        if value is not None:
            raise ValueError(
                f"{name}{_given(value)}: {file} holds a chart, whose picture has no use for it; leave {name} out."
            )


def _refuse_ignored(kind: Picture, options: dict[str, Any]) -> None:
    """Options that this kind of picture would ignore are refused."""
    of_diagrams = (
        "-x",
        "-y",
        "--xlim",
        "--ylim",
        "--color",
        "--marks",
        "--words",
        "--no-legend",
        "--compare",
        "--inset",
        "--no-inset",
    )
    takes = {
        Picture.diagram: (of_diagrams, "draws all branches"),
        Picture.multipliers: (("--branch",), "draws over the parameter"),
        Picture.network: ((), "draws boxes and arrows"),
    }
    known, why = takes[kind]
    for name, value in options.items():
        if value is not None and name not in known:
            other = Picture.multipliers if name == "--branch" else Picture.diagram
            raise ValueError(
                f"{name}{_given(value)}: --kind {kind.value} {why} and has no use for it; leave {name} out, "
                f"or choose --kind {other.value}."
            )


def _given(value: object) -> str:
    """An option's value as it was typed; nothing for a switch."""
    if isinstance(value, bool) or value == "":
        return ""
    return " " + (" ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else str(value))
