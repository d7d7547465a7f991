"""A brute-force sweep as dots, over the continued branches if there are any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..continuation.settings import hinting
from .diagram import draw_diagram
from .figures import Size, Style, is_low, narrower, new_axes, settle, styled, thin_ticks
from .legends import NARROW, Key, draw_legend
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph

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
    points : (parameter value, measure) of motions that recur; B at every impact, or over branches at the impact
        that their lines show.
    parameter : name of the parameter.
    graph : branches drawn beneath, with the same measure (B at their first impact).
    measure : name of the measure.
    others : the same at other impacts, drawn lighter.
    wandering : the same of motions that do not recur (modulated, chaotic).
    bands : (parameter value, lowest, mean, highest) of the largest responses per forcing period of modulated motions.
    axes, legend, figsize, style : as for :func:`contvines.plots.diagram.plot_diagram`.
    units : of the parameter and the measure by name, where they have some.
    notation : labels of axes by name of parameter or measure; the graph's by default.
    """
    said = dict(units or {})
    if notation is None and graph is not None:
        notation = graph.notation
    at = ("B at every impact" if graph is None else "B at the first impact") if measure == "B" else ""
    size = 2.4 if measure == "B" else 3.0
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, figsize)
        above = 3.5 if measure != "B" or graph is not None else 2.0
        dark = "0.45" if measure == "B" and graph is None else "black"
        narrow = own and narrower(axes, NARROW)  # the axis says what it is of
        told = f"simulated: {at or 'periodic'}" if not narrow or measure != "B" else "simulated"
        lost = {"markersize": 1.5} if measure == "B" else {"marker": "o", "markersize": 2.6, "mfc": "none"}
        _dots(axes, wandering, "simulated: not periodic", color=WANDERING, zorder=1.8, **lost)
        draw_bands(axes, bands)
        _dots(axes, others, "simulated: B at other impacts", color="0.72", zorder=1.9, markersize=size)
        _dots(axes, points, told, color=dark, zorder=above, markersize=size)
        if not any(len(dots) for dots in (points, others, wandering)):
            what = "no impacts" if measure == "B" else "nothing"
            axes.plot([], [], linestyle="none", label=f"simulated: {what}")
        low = own and is_low(axes)
        unit = f" [{said['B']}]" if "B" in said else ""
        axes.set_xlabel(axis_label(parameter, unit=said.get(parameter), notation=notation))
        axes.set_ylabel(
            f"$B$ at the impacts{unit}"
            if measure == "B"
            else axis_label(measure, low, said.get(measure), notation)
        )
        if graph is not None:
            draw_diagram(axes, graph, parameter, measure, own, legend=legend)
            return figure
        draw_legend(axes, Key(), legend, own, np.empty((0, 2)))
        if own:
            settle(figure)
            thin_ticks(axes)
    return figure


def draw_bands(axes: Axes, bands: Sequence[Band], color: str = WANDERING) -> None:
    """Bars from the lowest to the highest response per forcing period of modulated motions, with their mean."""
    if len(bands):
        values, low, mean, high = zip(*bands)
        look = {"color": color, "alpha": 0.35, "lw": 2.5, "zorder": 1.5}
        axes.vlines(values, low, high, label="modulated, by period", **look)
        axes.plot(values, mean, "_", color=color, markersize=4, zorder=1.6)


def _dots(axes: Axes, dots: Dots, label: str, **style: object) -> None:
    """One kind of dots; none, and no entry in the legend, where there are none."""
    if len(dots):
        values = np.array(dots, float).reshape(-1, 2)
        axes.plot(values[:, 0], values[:, 1], **{"linestyle": "none", "marker": ".", "label": label, **style})
