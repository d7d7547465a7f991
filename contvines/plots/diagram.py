"""The bifurcation diagram: branches as curves, special points as labelled marks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..graph.measures import default_measure
from .figures import freeze, new_axes, settle, styled
from .legends import draw_legend, hold_legend
from .picture import Picture
from .style import axis_label
from .views import frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph

LOW = 2.6  # inches: lower axes have the symbol of a measure alone at their side
COLORS = ("branch", "word", "stability")


def plot_diagram(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    axes: Axes | None = None,
    labels: bool | Sequence[str] = True,
    ends: bool = False,
    words: bool = False,
    color: str = "branch",
    legend: bool | str = True,
    name: str | None = None,
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> Figure:
    """Draw a graph: solid stable, dashed unstable, dotted virtual, special points marked and labelled.

    Parameters
    ----------
    graph : Graph
    x, y : str, optional
        Names of measures; by default the continuation parameter, and the problem's `default_measure` or first measure.
        Where a measure has a value at each point of a cycle (`x0` of a map), every one is drawn.
    axes : Axes, optional
        Drawn on; without, a new figure. A second graph on the same axes shares the legend; its labels have a prime, or `name`.
    labels : bool or sequence of str
        Write the labels of branches and special points: all for which there is room, none, or exactly these.
    ends : bool
        Mark the ends of the interval, too.
    words : bool
        Write the words of the motions along the branches instead of the branches' labels.
    color : {"branch", "word", "stability"}
        What a colour stands for.
    legend : bool or str
        Whether, or where: "inside", "beside", "below", or a place that matplotlib knows.
    name : str, optional
        Put before the labels, to tell graphs on the same axes apart.
    xlim, ylim : (float, float), optional
        Limits; labels are placed and curves refined for what is seen then, and again when the limits change later.
    figsize : (float, float), optional
        Inches, of a new figure.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the house's.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If the problem has no such measure, a label is unknown, or an option has no such value.
    """
    if color not in COLORS:
        raise ValueError(f"color = {color!r} is unknown; choose one of {', '.join(COLORS)}")
    _check_labels(graph, labels)
    x = x or graph.parameter
    y = y or default_measure(graph)
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, figsize=figsize)
        picture = Picture(axes, graph, x, y, color, name)
        picture.draw_branches()
        picture.draw_points(ends)
        frame(axes, graph, picture.curves, x, y, xlim, ylim)
        if own or not axes.get_xlabel():
            axes.set_xlabel(axis_label(x, unit=graph.units.get(x)))
        if own or not axes.get_ylabel():
            axes.set_ylabel(
                axis_label(y, axes.get_window_extent().height < LOW * figure.dpi, graph.units.get(y))
            )
        settle(figure)
        picture.refine()
        picture.key_of_marks()
        draw_legend(axes, picture.key, legend, own, picture.obstacles())
        settle(figure)
        if own:
            freeze(figure)
        taken = hold_legend(axes)
        if labels is not False:
            picture.write_labels(labels, words, taken)
            picture.follow_zoom()
        if not graph.finished:
            axes.set_title("unfinished", color="0.4")
    return figure


def _check_labels(graph: Graph, labels: bool | Sequence[str]) -> None:
    if isinstance(labels, bool):
        return
    if isinstance(labels, str):
        raise ValueError(f"labels = {labels!r}: give True, False or a list, for example [{labels!r}]")
    unknown = [label for label in labels if label not in graph]
    if unknown:
        known = ", ".join([*graph.branches, *graph.special])
        raise ValueError(f"labels: the graph has no {unknown[0]!r}; it has {known}")
