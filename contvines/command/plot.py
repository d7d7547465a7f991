"""`contvines plot`: pictures of a stored graph."""

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from contvines.command.compare import check_compared, compared
from contvines.command.frame import beside, say_state
from contvines.command.options import (
    CompareOption,
    FileArgument,
    SizeOption,
    TrustOption,
    XOption,
    YOption,
    given,
    option,
    picture,
)


class Picture(StrEnum):
    """What `plot` draws."""

    diagram = "diagram"
    multipliers = "multipliers"
    network = "network"


GENERAL = ("--output", "--size", "--style", "--trust")  # options for every picture


class Colors(StrEnum):
    """What a colour of a diagram stands for."""

    branch = "branch"
    word = "word"
    stability = "stability"


def plot(
    context: typer.Context,
    file: FileArgument,
    x: XOption = None,
    y: YOption = None,
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

    check_compared(compare, True)
    asked = given(context)
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
    from contvines.store import load

    graph = load(file, trust=trust)
    if isinstance(graph, Chart):
        from contvines.plots.chart import plot_chart

        ignored = next((line for name, line in asked.items() if name not in (*GENERAL, "--no-legend")), None)
        if ignored is not None:
            raise ValueError(
                f"{ignored}: {file} holds a chart, whose picture has no use for it; leave {ignored.split()[0]} out."
            )
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


def _refuse_ignored(kind: Picture, asked: dict[str, str]) -> None:
    """Options that this kind of picture would ignore are refused."""
    why = {
        Picture.diagram: "draws all branches",
        Picture.multipliers: "draws over the parameter",
        Picture.network: "draws boxes and arrows",
    }
    for name, line in asked.items():
        other = Picture.multipliers if name == "--branch" else Picture.diagram
        if kind is not other and name not in (*GENERAL, "--kind"):
            raise ValueError(
                f"{line}: --kind {kind.value} {why[kind]} and has no use for it; leave {name} out, "
                f"or choose --kind {other.value}."
            )
