"""An atlas: the diagram with all its components, and beneath it the shares of the attractors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.shortening import short_word
from .basins import COLORS
from .diagram import plot_diagram
from .figures import freeze, new_figure, settle, styled
from .picture import lay_out_again
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph

MOST = 8  # words with a colour of their own; the rest share one


def plot_atlas(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
    **options: Any,
) -> Figure:
    """Draw the diagram and, beneath it, which share of the starts reaches which motion, stacked against the parameter.

    Parameters
    ----------
    graph : Graph
        With ``attractors``.
    x, y, options
        As for :func:`contvines.plots.diagram.plot_diagram`.

    Raises
    ------
    ValueError
        If the graph has no attractors.
    """
    if not graph.attractors:
        raise ValueError("the graph has no attractors: contvines atlas makes one with, from a study")
    with styled(style):
        figure = new_figure(figsize=figsize or (7.2, 6.4))
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1))
        plot_diagram(graph, x, y, axes=upper, style=style, **options)
        upper.set_xlabel("")
        upper.tick_params(labelbottom=False)
        draw_shares(lower, graph)
        lower.set_xlabel(axis_label(graph.parameter, unit=graph.units.get(graph.parameter)))
        settle(figure)
        freeze(figure)
        lay_out_again(upper)
    return figure


def draw_shares(axes: Axes, graph: Graph) -> None:
    """Bars at each value of the parameter, stacked: the shares of the motions, each with one colour."""
    values = np.array(sorted({a.value for a in graph.attractors}))
    low, high = graph.within
    edges = np.concatenate([[low], 0.5 * (values[1:] + values[:-1]), [high]])
    names: dict[tuple[str, int], float] = {}
    for about in graph.attractors:
        key = (about.name, about.periods)
        names[key] = names.get(key, 0.0) + about.share
    shown = sorted(names, key=lambda key: -names[key])[:MOST]
    order = [key for key in names if key in shown]
    bottoms = np.zeros(len(values))
    for k, key in enumerate([*order, None]):
        heights = np.zeros(len(values))
        for about in graph.attractors:
            own = (about.name, about.periods)
            if own == key or (key is None and own not in shown):
                heights[np.searchsorted(values, about.value)] += about.share
        if not heights.any():
            continue
        name = "others" if key is None else short_word(key[0], 14)
        if key is not None and sum(key[0] == other for other, _ in order) > 1:
            name = f"{name}, k={key[1]}"
        color = "0.8" if key is None else COLORS[k % len(COLORS)]
        axes.bar(
            edges[:-1], heights, np.diff(edges), bottoms, align="edge", color=color, label=name, linewidth=0
        )
        bottoms += heights
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("share of starts")
    axes.grid(False)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
