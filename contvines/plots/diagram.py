"""The bifurcation diagram: branches as curves, special points as labelled marks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kinds import BY_NAME
from ..continuation.settings import hinting
from ..graph.stretches import default_measure
from ..shared.numbers import TINY
from .figures import Size, Style, freeze, is_low, new_axes, root, settle, styled, thin_ticks
from .labels import Region
from .legends import draw_legend, hold_legend
from .picture import Picture
from .settings import DRAWING
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph
    from .curves import Curve


COLORS = ("branch", "word", "stability")


@hinting
def plot_diagram(
    graph: Graph,
    x: str | None = None,
    y: str | None = None,
    *,
    axes: Axes | None = None,
    labels: bool | Sequence[str] = True,
    ends: bool = False,
    marks: bool | Sequence[str] = True,
    words: bool = False,
    color: str = "branch",
    legend: bool | str = True,
    name: str | None = None,
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    inset: bool | Region | None = None,
    figsize: Size = None,
    style: Style = None,
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
    marks : bool or sequence of str
        Mark the special points: all, none, or those of these kinds, by name or label: ``["fold", "SB"]``.
    words : bool
        Write the words of the motions along the branches instead of the branches' labels.
    color : {"branch", "word", "stability"}
        What a colour stands for.
    legend : bool or str
        Whether, or where: "inside", "beside", "below", or a place that matplotlib knows.
    name : str, optional
        Put before the labels, to tell graphs on the same axes apart.
    xlim, ylim : (float, float), optional
        Limits; labels are placed and curves refined for what is seen then, and again when the limits change later. With
        `xlim` alone the height is that of what is seen.
    inset : bool or ((float, float), (float, float)), optional
        Draw the most crowded place, or these limits, once more in a free part of the axes. By default where a figure of
        ours has a crowded place and room.
    figsize : (float, float), optional
        Inches, of a new figure.
    style : str or mapping, optional
        "aps", "elsevier", "springer" (one column), "grey", "slides", a style of matplotlib's, several of them ("aps,grey"), or
        rcParams; they come before the package's.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If the problem has no such measure, a label is unknown, or an option has no such value.
    """
    if color not in COLORS:
        raise ValueError(
            f"color = {color!r} is unknown{did_you_mean(color, COLORS)}; choose one of {', '.join(COLORS)}"
        )
    _check_labels(graph, labels)
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, figsize)
        draw_diagram(
            axes, graph, x, y, own, labels=labels, ends=ends, marks=marks, words=words, color=color, legend=legend, name=name,
            limits=(xlim, ylim), inset=own if inset is None else inset,
        )  # fmt: skip
    return figure


def draw_diagram(
    axes: Axes,
    graph: Graph,
    x: str | None,
    y: str | None,
    own: bool,
    *,
    labels: bool | Sequence[str] = True,
    ends: bool = False,
    marks: bool | Sequence[str] = True,
    words: bool = False,
    color: str = "branch",
    legend: bool | str = True,
    name: str | None = None,
    limits: tuple[tuple[float, float] | None, tuple[float, float] | None] = (None, None),
    inset: bool | Region = False,
) -> Picture:
    """Draw a graph as :func:`plot_diagram` does, in the style of the moment; `own` says whether the figure is ours to be laid out."""
    figure = root(axes)
    x, y = x or graph.parameter, y or default_measure(graph)
    picture = Picture(axes, graph, x, y, color, name)
    picture.draw_branches()
    picture.draw_points(ends, _marked(graph, marks))
    picture.draw_unresolved()
    frame(axes, picture.curves, *limits)
    if not axes.get_xlabel():
        axes.set_xlabel(axis_label(x, unit=graph.units.get(x), notation=graph.notation))
    if not axes.get_ylabel():
        axes.set_ylabel(axis_label(y, is_low(axes), graph.units.get(y), notation=graph.notation))
    picture.refine()  # what the layout changes of the axes' size later does not show in it
    if limits[0] is not None and limits[1] is None:
        fit_height(axes)  # once more: curves between stored points are known now
        picture.refine()
    picture.key_of_marks()
    draw_legend(axes, picture.key, legend, own, picture.obstacles())
    settle(figure)
    if own:
        thin_ticks(axes)
        freeze(figure)
    hold_legend(axes)
    picture.show_inset(inset, words)
    if labels is not False:
        picture.write_labels(labels, words, hold_legend(axes))
        picture.follow_zoom()
    if not graph.finished:
        axes.set_title("unfinished", color="0.4")
    return picture


def _check_labels(graph: Graph, labels: bool | Sequence[str]) -> None:
    if isinstance(labels, bool):
        return
    if isinstance(labels, str):
        raise ValueError(f"labels = {labels!r}: give True, False or a list, for example [{labels!r}]")
    unknown = [label for label in labels if label not in graph]
    if unknown:
        known = ", ".join([*graph.branches, *graph.special])
        raise ValueError(f"labels: the graph has no {unknown[0]!r}; it has {known}")


def _marked(graph: Graph, marks: bool | Sequence[str]) -> list[str] | None:
    """Names of the kinds that get marks; None for all."""
    if isinstance(marks, bool):
        return None if marks else []
    kinds = {**BY_NAME, **graph.own_kinds}
    by_label = {kind.label: name for name, kind in kinds.items()}
    wanted = [marks] if isinstance(marks, str) else list(marks)
    for name in wanted:
        if name not in kinds and name not in by_label:
            raise ValueError(
                f"marks: there is no kind {name!r}{did_you_mean(name, [*kinds, *by_label])}; give names or labels, for example ['fold', 'SB']"
            )
    return [by_label.get(name, name) for name in wanted]


RUNAWAY = 6.0  # a range so many times wider than where special points and most points lie is not shown whole
UPRIGHT = 1e-6  # part of the width of a picture: a line that is narrower stands upright
MOST = (4.0, 96.0)  # per cent: where most points lie


def frame(
    axes: Axes, curves: list[Curve], xlim: tuple[float, float] | None, ylim: tuple[float, float] | None
) -> None:
    """Set the limits: the asked ones, else all that is drawn but the far ends of branches that run away.

    Where only the interval across is asked for, the height is that of what is seen in it.
    """
    axes.margins(0.04)
    axes.autoscale_view()
    if xlim is not None:
        axes.set_xlim(*xlim)
    if ylim is not None:
        axes.set_ylim(*ylim)
        return
    if xlim is not None:
        fit_height(axes)
        return
    drawn = [v for curve in curves for _, ys in curve.strands() for v in ys[np.isfinite(ys)]]
    heights = [np.atleast_1d(np.asarray(line.get_ydata(), dtype=float)) for line in axes.lines]
    marks = [float(one[0]) for one in heights if len(one) == 1 and np.isfinite(one[0])]
    limits = _without_runaways(np.array(drawn), np.array(marks), _leaning(curves, axes.get_xlim()))
    if limits is not None and axes.get_yscale() == "linear":
        axes.set_ylim(*limits)


def fit_height(axes: Axes) -> None:
    """Make the axes as high as the lines between their limits across; as they are where there are none."""
    left, right = sorted(axes.get_xlim())
    seen: list[np.ndarray] = []
    for line in axes.lines:
        if not line.get_transform().contains_branch(axes.transData):
            continue
        x, y = (np.asarray(v, dtype=float) for v in line.get_data())
        seen.append(y[(x >= left) & (x <= right) & np.isfinite(y)])
        if len(x) < 2 or line.get_linestyle() in ("None", "none", ""):
            continue
        for edge in (left, right):  # where a line crosses an edge of what is seen
            first = np.flatnonzero((np.minimum(x[:-1], x[1:]) < edge) & (np.maximum(x[:-1], x[1:]) > edge))
            share = (edge - x[first]) / (x[first + 1] - x[first])
            seen.append(y[first] + share * (y[first + 1] - y[first]))
    values = np.concatenate([np.empty(0), *seen])
    values = values[np.isfinite(values)]
    if not values.size:
        return
    low, high = float(values.min()), float(values.max())
    if axes.get_yscale() == "log":
        axes.set_ylim(low / (high / low) ** 0.06, high * (high / low) ** 0.06)
        return
    room = high - low
    least = DRAWING.slack * max(abs(low), abs(high), TINY)  # a level line has a height of its own
    pad = 0.06 * room if room > least else 0.05 * max(abs(low), abs(high)) or 1.0
    limits = None if values.size < 10 else _without_runaways(values, np.empty(0))
    axes.set_ylim(*(limits or (low - pad, high + pad)))


def _leaning(curves: list[Curve], limits: tuple[float, float]) -> np.ndarray:
    """Heights along all branches but those that stand upright, as families of cycles at one value of the parameter, which have all amplitudes."""
    strands = [strand for curve in curves for strand in curve.strands()]
    least = UPRIGHT * abs(limits[1] - limits[0])
    kept = [ys[np.isfinite(ys)] for xs, ys in strands if xs.size and np.nanmax(xs) - np.nanmin(xs) > least]
    return np.concatenate([np.empty(0), *kept])


def _without_runaways(
    values: np.ndarray, marks: np.ndarray, most: np.ndarray | None = None
) -> tuple[float, float] | None:
    """Narrower limits where a few points, or those that are not among `most`, lie far from all others; None where all may be shown."""
    if values.size < 10:
        return None
    typical = values if most is None or most.size < 10 else most
    inner = np.concatenate([np.percentile(typical, MOST), marks])
    low, high = float(inner.min()), float(inner.max())
    room = high - low
    if not room > 0.0 or float(np.ptp(values)) <= RUNAWAY * room:
        return None
    least, largest = float(values.min()), float(values.max())
    return max(low - 0.5 * room, least - 0.04 * room), min(high + 0.5 * room, largest + 0.04 * room)
