"""Picture of a brute-force sweep: attractors as dots, over the branches of a graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..continuation.settings import hinting
from ..graph import Graph
from ..shared.figures import Size, Style, drawing
from .diagram import draw_diagram
from .legends import place_legend
from .style import axis_label

Dots = Sequence[tuple[float, float]]
Band = tuple[float, float, float, float]
WANDERING = "#d95f02"


@hinting
def plot_sweep(
    points: Dots,
    parameter: str,
    graph: Graph | None = None,
    measure: str = "B",
    *,
    others: Dots = (),
    wandering: Dots = (),
    bands: Sequence[Band] = (),
    axes: Axes | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
    units: Mapping[str, str] | None = None,
    notation: Mapping[str, str] | None = None,
) -> Figure:
    """Draw the attractors of a sweep.

    Parameters
    ----------
    points : sequence of (float, float)
        (parameter value, measure) of periodic motions. B is that of every impact, or, with a graph, of the impact that its branches show.
    parameter : str
    graph : Graph, optional
        Branches to be drawn, with the same measure.
    measure : str
        Name of the measure.
    others : sequence of (float, float)
        As `points`, for B at the other impacts; drawn lighter.
    wandering : sequence of (float, float)
        As `points`, for motions without a period (modulated, chaotic).
    bands : sequence of (float, float, float, float)
        (parameter value, lowest, mean, highest) of the largest responses per forcing period of modulated motions.
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    units : mapping, optional
        Units by name of parameter or measure.
    notation : mapping, optional
        Axis labels by name of parameter or measure; by default those of the graph.
    """
    units, notation = units or {}, notation or (graph.notation if graph is not None else {})
    impacts = measure == "B"
    which = "periodic" if not impacts else "B at every impact" if graph is None else "B at the first impact"
    size, hollow = (2.4, {}) if impacts else (3.0, {"marker": "o", "markersize": 2.6, "mfc": "none"})
    with drawing(axes, style, figsize) as (figure, axes, own):
        for dots, label, look in (
            (wandering, "not periodic", {"color": WANDERING, "zorder": 1.8, "markersize": 1.5, **hollow}),
            (others, "B at other impacts", {"color": "0.72", "zorder": 1.9, "markersize": size}),
            (points, which, {"color": "black", "zorder": 3.5, "markersize": size}),
        ):
            if len(dots):
                look = {"linestyle": "none", "marker": ".", "label": f"simulated: {label}", **look}
                axes.plot(*np.array(dots, float).reshape(-1, 2).T, **look)
        draw_bands(axes, bands)
        if not any(len(dots) for dots in (points, others, wandering)):
            axes.plot([], [], ls="none", label=f"simulated: {'no impacts' if impacts else 'nothing'}")
        axes.set_xlabel(axis_label(parameter, units.get(parameter), notation))
        axes.set_ylabel(axis_label(measure, units.get(measure), {**notation, "B": "$B$ at the impacts"}))
        if graph is not None:
            draw_diagram(axes, graph, parameter, measure, own, legend=legend)
        else:
            place_legend(axes, (), legend, own)
    return figure


def draw_bands(axes: Axes, bands: Sequence[Band], color: str = WANDERING) -> None:
    """Draw bars from the lowest to the highest response per forcing period of modulated motions, with marks at the mean."""
    if len(bands):
        values, low, mean, high = zip(*bands)
        look = {"color": color, "alpha": 0.35, "lw": 2.5, "zorder": 1.5}
        axes.vlines(values, low, high, label="modulated, by period", **look)
        axes.plot(values, mean, "_", color=color, markersize=4, zorder=1.6)
