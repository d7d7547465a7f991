"""Picture of a chart: loci coloured by kind, borders with strokes on their virtual side, regions with their stable motions, points of codimension two."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import TickedStroke

from ..continuation.settings import hinting
from ..graph.table import short_word
from ..loci.chart import Chart
from ..loci.locus import Locus
from ..shared.figures import Size, Style, drawing, finish_layout
from ..shared.motions import MODULATIONS
from .labels import CELL, Label, Raster, grouped, place_labels
from .legends import hold_legend, place_legend
from .style import BORDERS, HATCHES, LOCI, axis_label, kind_of_locus

HATCHED = "#d9d9d9"
TINTS = ("#dbe9f6", "#fbe3d6", "#e3f1e0", "#efe4f5", "#fdf3cf", "#d9f0f0", "#f6dfe6", "#e9e9e4")
STROKE = 4.5  # points: distance of the strokes along a border
CROSSED = 8  # largest weight of curves under a name of a region (see `Raster`)
FITS = 0.88  # part of the width and height of a name that must lie within its region
WIDTH = 14  # characters per line of the name of a modulation
LEAST_SHARE = 0.012  # part of the plane: smaller regions have no name


@hinting
def plot_chart(
    chart: Chart,
    axes: Axes | None = None,
    labels: bool = True,
    names: bool = True,
    legend: bool | str = True,
    style: Style = None,
    figsize: Size = None,
) -> Figure:
    """Draw a chart: loci solid where they are real and dotted where they are virtual, with the stable motions of each region.

    Parameters
    ----------
    chart : Chart
    labels : bool
        Label the points of codimension two.
    names : bool
        Write the stable motions into each region.
    axes, legend, style, figsize
        As for :func:`contvines.plots.diagram.plot_diagram`; by default the legend is below a new figure, and inside given axes.
    """
    with drawing(axes, style, figsize) as (figure, axes, own):
        handles: dict[str, Artist] = {}
        _tint(axes, chart)
        for locus in chart.loci.values():
            _draw(axes, locus, handles)
        axes.set(xlim=chart.within[0], ylim=chart.within[1])
        for point in chart.points.values():
            color = "black" if point.real else "0.6"
            axes.plot(*point.value, "o", color=color, markersize=4, zorder=5)
        across, up = (axis_label(name, chart.units.get(name), chart.notation) for name in chart.parameters)
        axes.set(xlabel=across, ylabel=up)
        place_legend(axes, list(handles.values()), legend, own, usual="below")
        finish_layout(figure, own)
        hold_legend(axes)
        if names:
            _name(axes, chart)
        if labels:
            wanted = [
                Label(point.label, *point.value, rank=not point.real) for point in chart.points.values()
            ]
            place_labels(axes, grouped(axes, wanted), 0.8 * float(rcParams["font.size"]))
    return figure


def _draw(axes: Axes, locus: Locus, handles: dict[str, Artist]) -> None:
    """Draw a locus: solid with a few marks where it is real, else dotted; strokes show the side of a border on which the motion is virtual."""
    values, real = locus.values, locus.real
    solid, dotted = values.copy(), values.copy()
    both = real[:-1] & real[1:]
    solid[~(np.append(both, False) | np.append(False, both))] = np.nan
    dotted[np.append(both, True) & np.append(True, both)] = np.nan
    border, kind = locus.kind not in LOCI, kind_of_locus(locus)
    color = (LOCI | BORDERS).get(locus.kind, "#6b6b6b")
    look: dict[str, Any] = {"color": color, "label": kind.text, "zorder": 3}
    (line,) = axes.plot(*dotted.T, linestyle=":", linewidth=1.0, **look)
    if np.isfinite(solid).any():  # marks cannot be spaced on a line without finite points
        look |= {"linewidth": float(rcParams["lines.linewidth"]) * (0.65 if border else 0.95)}
        look |= {"marker": kind.marker, "markersize": 4.0, "markeredgewidth": 0.8}
        look["markerfacecolor"] = color if kind.filled else "white"
        # first mark and distance of marks, relative to the axes' diagonal: kinds differ without colours
        (line,) = axes.plot(*solid.T, markevery=(0.07, 0.23), **look)
    if border and locus.seed is not None and locus.beyond:
        stroke = TickedStroke(spacing=STROKE, angle=-90 * locus.beyond, length=0.65, linewidth=0.6)
        axes.plot(*solid.T, color=color, zorder=2, path_effects=[stroke])
    handles.setdefault(kind.text, line)


def _tint(axes: Axes, chart: Chart) -> None:
    """Tint and hatch the regions; regions with the same stable motions look alike."""
    seen: dict[tuple[str, ...], int] = {}
    for region in chart.regions:
        place = seen.setdefault(tuple(sorted(region.words)), len(seen))
        if not region.cells.size:
            continue
        xs, ys = (
            np.concatenate(([low], low + (np.arange(n) + 0.5) * (high - low) / n, [high]))
            for n, (low, high) in zip(region.cells.shape, chart.within, strict=True)
        )
        inside = np.pad(region.cells.T.astype(float), 1, mode="edge")
        hatch, size = HATCHES[place % len(HATCHES)], len(TINTS)
        axes.contourf(xs, ys, inside, [0.5, 1.5], colors=[TINTS[place % size]], zorder=0)
        if hatch:
            lines = axes.contourf(xs, ys, inside, [0.5, 1.5], colors="none", hatches=[hatch], zorder=0.5)
            lines.set(edgecolor=HATCHED, linewidth=0.0)


def _name(axes: Axes, chart: Chart) -> None:
    """Write the stable motions into each region, as near to its middle as the text fits into the region and covers no label."""
    low, high = np.array(chart.within).T
    for region in chart.regions:
        if region.share < LEAST_SHARE or not region.words:
            continue
        raster = Raster(axes)
        inside = np.ones(raster.weights.shape, dtype=bool)
        middle = axes.transData.transform(region.at)
        if region.cells.size:
            corners = raster.origin + CELL * np.indices(raster.weights.shape).reshape(2, -1).T
            share = (axes.transData.inverted().transform(corners) - low) / (high - low)
            i, j = np.clip(share * region.cells.shape, 0, np.array(region.cells.shape) - 1).astype(int).T
            inside = region.cells[i, j].reshape(raster.weights.shape)
        for count in (4, 2, 1):  # largest number of motions
            names = [
                textwrap.fill(word, WIDTH) if word in MODULATIONS else short_word(word, 16)
                for word in region.words[:count]
            ]
            more = [f"+{len(region.words) - count}"] if len(region.words) > count else []
            more += ["(in part)"] if region.others else []
            look = {"ha": "center", "va": "center", "fontsize": "x-small", "color": "0.25", "zorder": 4}
            text = axes.text(*region.at, "\n".join([*names, *more]), **look)
            size = FITS * np.asarray(text.get_window_extent().size)
            places = raster.free(size, inside)
            places = places[raster.covered(np.hstack([places, places + size])) <= CROSSED]
            if len(places):
                at = places[np.argmin(np.hypot(*(places + 0.5 * size - middle).T))] + 0.5 * size
                x, y = axes.transData.inverted().transform(at)
                text.set_position((x, y))
                break
            text.remove()
