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
from ..graph.contents import Attractor
from ..graph.table import told_apart
from ..shared.figures import Size, Style, fit, narrower, panels, settle
from .basins import COLORS
from .diagram import draw_diagram
from .legends import NARROW, place_legend
from .style import HATCHES, axis_label

MOST, FEW = 8, 5  # largest number of attractors with a colour of their own: usually, and in a low figure
LOW = 3.4  # inches: a lower figure has less text


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
    small = own and size[1] < LOW

    below = {"mosaic": "a;b", "sharex": True, "height_ratios": (1.8 if small else 2.4, 1)}
    with panels(axes, (2,), "an atlas is drawn on", size, style, below) as (figure, (upper, lower)):
        picture = draw_diagram(upper, graph, x, y, False, legend=False, **options)
        if own:
            upper.set_xlabel("")
            upper.tick_params(labelbottom=False)
        draw_shares(lower, graph, FEW if small else MOST)
        unit = graph.units.get(graph.parameter)
        lower.set_xlabel(axis_label(graph.parameter, unit=unit, notation=graph.notation))
        if small:
            lower.set_ylabel("share")
        # a high figure has both legends: one below the other if the panels leave no room beside them
        if own and not small and (narrower(lower, NARROW) or legend == "below"):
            place_legend(lower, picture.handles(), legend, own, remarks=picture.remarks)
        else:
            place_legend(lower, (), legend, own, usual="beside")  # first: narrows both panels
            if not small:
                place_legend(upper, picture.handles(), legend, own, remarks=picture.remarks)
        if own:
            fit(figure, frozen=True)
        settle(figure)
        picture.lay_out()
    return figure


def draw_shares(axes: Axes, graph: Graph, most: int = MOST) -> None:
    """Draw the shares of the attractors as stacked bars over the parameter; the `most` largest attractors have a colour each.

    Neighbouring values with few starts share a bar, so that each bar stands for about as many starts as the value with the most starts.
    """
    met = [a for a in graph.attractors if a.starts] or graph.attractors
    values = np.array(sorted({a.value for a in met}))
    low, high = graph.within
    starts = np.array([max(next(a.starts for a in met if a.value == v), 1) for v in values], dtype=float)
    group = ((np.cumsum(starts) - starts) // starts.max()).astype(int)
    group = np.unique(group, return_inverse=True)[1]
    if group[-1] and starts[group == group[-1]].sum() < 0.5 * starts.max():
        group[group == group[-1]] -= 1  # too few starts for a bar of their own
    last = np.flatnonzero(np.diff(group))
    edges = np.concatenate([[low], 0.5 * (values[last] + values[last + 1]), [high]])
    weights = starts / np.bincount(group, weights=starts)[group]
    at_once = Counter((about.value, about.name, about.periods) for about in met)
    many = {key[1:] for key, count in at_once.items() if count > 1}

    def key_of(about: Attractor) -> tuple[str, int, str]:
        """Return name and period of an attractor, and its branch if coexisting attractors share name and period."""
        own = about.name, about.periods
        return *own, (about.branch or "") if own in many else ""

    total: defaultdict[tuple[str, int, str], float] = defaultdict(float)
    for about in met:
        total[key_of(about)] += about.share
    shown = sorted(total, key=lambda key: -total[key])[:most]
    order: list[tuple[str, int, str] | None] = [*(key for key in total if key in shown), None]  # None: others
    heights = {key: np.zeros(len(edges) - 1) for key in order}
    for about in met:
        key, i = key_of(about), int(np.searchsorted(values, about.value))
        heights[key if key in shown else None][group[i]] += about.share * weights[i]
    periods = {(name, count) for name, count, _ in shown}
    named = Counter(name for name, _ in periods)
    short = told_apart([key[0] for key in order if key], 14)
    bottoms = np.zeros(len(edges) - 1)
    for k, key in enumerate(order):
        if not heights[key].any():
            continue
        name = "others" if key is None else short[key[0]]
        if key is not None and named[key[0]] > 1:
            name = f"{name}, k={key[1]}"
        if key is not None and key[2]:
            name = f"{name} ({key[2]})"
        color, hatch = ("0.8", None) if key is None else (COLORS[k % len(COLORS)], HATCHES[k % len(HATCHES)])
        look = {"align": "edge", "facecolor": color, "hatch": hatch, "edgecolor": "white", "linewidth": 0}
        axes.bar(edges[:-1], heights[key], np.diff(edges), bottoms, label=name, **look)
        bottoms += heights[key]
    axes.set(ylim=(0.0, 1.0), ylabel="share of starts")
    axes.grid(False)
