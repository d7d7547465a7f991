"""`contvines plot`: pictures of a stored graph, and responses for comparison: bare oscillator, tuned absorber of equal mass, friction damper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from orbits.design.references import NAMES, reference
from orbits.machines.base import Model

from ..shared.numbers import figures
from .frame import beside, say_state
from .options import (
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

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.machines.varying import Varying

    from ..graph import Graph

GENERAL = ("--output", "--size", "--style", "--trust")  # options for every picture
SHOWN = ("max_abs_q1", "amplitude")
POINTS = 600


class Picture(StrEnum):
    """Pictures that `plot` can draw."""

    diagram = "diagram"
    multipliers = "multipliers"
    network = "network"


DRAWS = {
    Picture.diagram: "draws all branches",
    Picture.multipliers: "draws over the parameter",
    Picture.network: "draws boxes and arrows",
}


class Colors(StrEnum):
    """Meanings that the colours of a diagram can have."""

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
    from ..loci.chart import Chart
    from ..plots.figures import save_figure
    from ..shared.figures import styled
    from ..store import load

    asked = {name: line for name, line in given(context).items() if name not in GENERAL}
    for name, line in asked.items():
        other = Picture.multipliers if name == "--branch" else Picture.diagram
        if kind is not other and name != "--kind":
            raise ValueError(
                f"{line}: --kind {kind.value} {DRAWS[kind]} and has no use for it; leave {name} out, "
                f"or choose --kind {other.value}."
            )
    target = output or beside(file, ".png")
    picture(target)
    with styled(style):  # an unknown style is refused before any work
        pass
    for name, pair in (("--xlim", xlim), ("--ylim", ylim)):
        if pair is not None and not (math.isfinite(sum(pair)) and pair[0] < pair[1]):
            raise ValueError(
                f"{name} {pair[0]:g} {pair[1]:g}: give the lower number first, then the higher one."
            )
    graph = load(file, trust=trust)
    options: dict[str, Any] = {"figsize": size, "style": style}
    if isinstance(graph, Chart):
        from ..plots.chart import plot_chart

        for name, line in asked.items():
            if name != "--no-legend":
                raise ValueError(
                    f"{line}: {file} holds a chart, whose picture has no use for it; leave {name} out."
                )
        figure = plot_chart(graph, legend=legend, **options)
    else:
        say_state(graph, file)
        if not graph.branches:
            raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
        label = branch or next(iter(graph.branches))
        if label not in graph.branches:
            raise ValueError(
                f"--branch {label}: there is no such branch in {file}; it has {', '.join(graph.branches)}."
            )
        if kind is Picture.diagram:
            options |= {"words": words, "color": (color or Colors.branch).value, "legend": legend}
            options |= {"xlim": xlim, "ylim": ylim, "inset": inset is not False}
            options["marks"] = True if marks is None else [] if marks == "none" else marks.split(",")
            figure = compared(graph, compare, x, y, **options)
        elif kind is Picture.network:
            from ..plots.network import plot_network

            figure = plot_network(graph, **options)
        else:
            from ..plots.multipliers import plot_multipliers

            figure = plot_multipliers(graph.branches[label], **options)
    save_figure(figure, target)
    typer.echo(str(target))


# ---------------------------------------------------------------------- what a response is compared with
def compared(
    graph: Graph, kinds: Sequence[str] | None, x: str | None = None, y: str | None = None, **options: Any
) -> Figure:
    """Draw a graph with the responses for comparison; options as for `contvines.plots.diagram.plot_diagram`."""
    from ..plots.diagram import draw_diagram, plot_diagram
    from ..shared.figures import drawing

    if not kinds:
        return plot_diagram(graph, x, y, **options)
    with drawing(None, options.pop("style", None), options.pop("figsize", None)) as (figure, axes, own):
        draw_compared(axes, graph, kinds, x, y)
        limits = options.pop("xlim", None), options.pop("ylim", None)
        draw_diagram(axes, graph, x, y, own, limits=limits, **options)
    return figure


def draw_compared(axes: Axes, graph: Graph, kinds: Sequence[str], x: str | None, y: str | None) -> None:
    """Draw the responses for comparison on the axes of a graph's picture, before the graph itself.

    Raises
    ------
    ValueError
        If the picture does not show the response of an oscillator over the graph's parameter.
    """
    from orbits.problem import OrbitProblem

    from ..graph.stretches import default_measure
    from ..plots.style import REFERENCES

    measure, over = y or default_measure(graph), x or graph.parameter
    problem = next((branch.problem for branch in graph.branches.values() if branch.problem is not None), None)
    if (
        not isinstance(problem, OrbitProblem)
        or not isinstance(problem.model, Model)
        or "damping" not in problem.model.parameter_names
        or measure not in SHOWN
        or over != graph.parameter
    ):
        raise ValueError(
            f"--compare {kinds[0]}: this goes with the displacement of an oscillator ({' or '.join(SHOWN)}) over the parameter; "
            f"here {measure} is drawn over {over}."
        )
    values = np.linspace(*graph.within, POINTS)
    params = np.atleast_2d(problem.values(values))
    for kind in kinds:
        color, dashes = REFERENCES[kind]
        response = response_of(kind, problem.model, params)
        axes.plot(
            values, response, color=color, linestyle=dashes, linewidth=1.4, zorder=1.7, label=NAMES[kind]
        )


def response_of(kind: str, model: Model, params: np.ndarray) -> np.ndarray:
    """Return the response of a machine for comparison at parameter vectors (m, P), in the machine's unit, shape (m,)."""
    return reference(kind, model, params) * model.gauge("length", params)


def peaks_compared(
    model: Varying, over: str, within: tuple[float, float], kinds: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Return the largest response of each machine for comparison over an interval of a parameter, and its place, in the machine's units.

    Raises
    ------
    ValueError
        If the machine is declared: there are no closed forms then.
    """

    if not isinstance(model, Model):
        raise ValueError(f"the machine {model.name!r} has no closed forms to compare with")

    def grid(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
        values = np.linspace(low, high, POINTS)
        return values, np.array([model.vector_at(over, float(value)) for value in values])

    found, whole = {}, grid(*within)
    for kind in kinds:
        values, params = whole
        for narrower in (True, True, False):  # refine the grid between the neighbours of the maximum
            response = response_of(kind, model, params)
            place = int(response.argmax())
            found[kind] = float(response[place]), float(values[place])
            if narrower:
                values, params = grid(values[max(place - 1, 0)], values[min(place + 1, POINTS - 1)])
    return found


def compared_text(model: Varying, over: str, within: tuple[float, float], kinds: Sequence[str]) -> str:
    """Describe the largest responses of the machines for comparison in one sentence."""
    unit, place = model.units.get(SHOWN[0], ""), model.units.get(over, "")
    parts = [
        f"{NAMES[kind]} {figures(peak)} {unit} at {over} = {figures(at)} {place}".replace("  ", " ").rstrip()
        for kind, (peak, at) in peaks_compared(model, over, within, kinds).items()
    ]
    return f"to compare with, at most: {'; '.join(parts)}"
