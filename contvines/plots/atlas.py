"""Picture of an atlas: the diagram with all its components, and below it the shares of the attractors."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..continuation.settings import hinting
from ..graph import CurveOptions, Graph
from ..graph.table import told_apart
from ..shared.figures import Size, Style, finish_layout, narrower, panels
from .basins import COLORS
from .diagram import draw_diagram
from .legends import NARROW, place_legend
from .style import HATCHES, axis_label

MOST, FEW = 8, 5  # largest number of attractors with a colour of their own: usually, and in a low figure
LOW = 3.4  # inches: a lower figure has less text
Key = tuple[str, int, str]  # name and period of an attractor, and its branch if coexisting ones share both


@hinting
def plot_atlas(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    axes: Sequence[Axes] | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
    **options: Unpack[CurveOptions],
) -> Figure:
    """Draw the diagram and, below it, the share of the starts that reaches each attractor, stacked, over the parameter.

    Parameters
    ----------
    graph : Graph
        An atlas: a graph with ``attractors``.
    x, y, options
        As for :func:`contvines.plots.diagram.plot_diagram`; the shares are always drawn over the parameter.
    axes : two Axes, optional
        Axes for the diagram and for the shares. Default: a new figure.
    legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; a low figure has no legend of the diagram.

    Raises
    ------
    ValueError
        If the graph has no attractors, or the number of `axes` is not two.
    """
    if not graph.attractors:
        raise ValueError("the graph has no attractors: contvines atlas makes one with, from a study")
    own, size = axes is None, figsize or (7.2, 6.4)
    small, shared = own and size[1] < LOW, own and x in (None, graph.parameter)
    below = {"mosaic": "a;b", "sharex": shared, "height_ratios": (1.8 if small else 2.4, 1)}
    with panels(axes, (2,), "an atlas is drawn on", size, style, below) as (figure, (upper, lower)):
        picture = draw_diagram(upper, graph, x, y, False, legend=False, **options)
        if shared:
            upper.label_outer()
        draw_shares(lower, graph, FEW if small else MOST)
        lower.set_xlabel(axis_label(graph.parameter, graph.units.get(graph.parameter), graph.notation))
        # a high figure has both legends: one below the other if the panels leave no room beside them
        if own and not small and (narrower(lower, NARROW) or legend == "below"):
            place_legend(lower, picture.handles(), legend, own, remarks=picture.remarks)
        else:
            place_legend(lower, (), legend, own, usual="beside")  # first: narrows both panels
            if not small:
                place_legend(upper, picture.handles(), legend, own, remarks=picture.remarks)
        finish_layout(figure, own)
        picture.lay_out()
    return figure


def draw_shares(axes: Axes, graph: Graph, most: int) -> None:
    """Draw the shares of the attractors as stacked bars over the parameter; the `most` largest attractors have a colour each.

    Neighbouring values with few starts share a bar, so that each bar stands for about as many starts as the value with the most starts.
    """
    met = [about for about in graph.attractors if about.starts] or graph.attractors
    counts = {about.value: float(max(about.starts, 1)) for about in met}
    values, starts = np.array(sorted(counts.items())).T
    bar = ((np.cumsum(starts) - starts) // starts.max()).astype(int)
    bar = np.unique(bar, return_inverse=True)[1]
    if bar[-1] and starts[bar == bar[-1]].sum() < 0.5 * starts.max():
        bar[bar == bar[-1]] -= 1  # too few starts for a bar of their own
    last, (low, high) = np.flatnonzero(np.diff(bar)), graph.within
    edges = np.concatenate([[low], 0.5 * (values[last] + values[last + 1]), [high]])
    weights = starts / np.bincount(bar, weights=starts)[bar]

    alike = Counter((about.value, about.name, about.periods) for about in met)
    several = {key[1:] for key, count in alike.items() if count > 1}
    total: defaultdict[Key, float] = defaultdict(float)
    heights: defaultdict[Key, np.ndarray] = defaultdict(lambda: np.zeros(len(edges) - 1))
    for about in met:
        motion, i = (about.name, about.periods), int(np.searchsorted(values, about.value))
        key = *motion, (about.branch or "") if motion in several else ""
        total[key] += about.share
        heights[key][bar[i]] += about.share * weights[i]

    largest = sorted(total, key=lambda key: -total[key])[:most]
    shown = [key for key in total if key in largest]
    short = told_apart([name for name, _, _ in shown], 14)
    times = Counter(name for name, _ in {key[:2] for key in shown})
    layers = []
    for k, (name, periods, branch) in enumerate(shown):
        parts = [f", k={periods}"] * (times[name] > 1) + [f" ({branch})"] * bool(branch)
        fill = COLORS[k % len(COLORS)], HATCHES[k % len(HATCHES)]
        layers.append((short[name] + "".join(parts), heights[shown[k]], *fill))
    others = sum((heights[key] for key in total if key not in largest), np.zeros(len(edges) - 1))
    bottoms = np.zeros(len(edges) - 1)
    look = {"align": "edge", "edgecolor": "white", "linewidth": 0}
    for label, height, color, hatch in [*layers, ("others", others, "0.8", None)]:
        if height.any():
            look |= {"label": label, "facecolor": color, "hatch": hatch}
            axes.bar(edges[:-1], height, np.diff(edges), bottoms, **look)
            bottoms += height
    axes.set(ylim=(0.0, 1.0), ylabel="share of starts")
    axes.grid(False)
