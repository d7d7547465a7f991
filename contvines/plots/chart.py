"""A chart: loci by kind, borders hatched where the motion ends, regions tinted and named, points of codimension two."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.settings import hinting
from ..graph.table import short_word
from ..shared.motions import MODULATIONS
from .figures import Size, Style, freeze, is_low, new_axes, settle, styled, thin_ticks
from .labels import Box, Label, dense, grouped, place_labels, touching
from .legends import hold_legend, place_legend
from .style import HATCHES, axis_label, mark_of_locus

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    from ..loci.chart import Chart
    from ..loci.locus import Locus
    from ..loci.regions import Region

#: kind of locus -> colour; borders share one family
COLORS = {
    "fold": "#0b3c6f",
    "symmetry-breaking": "#1b7f4b",
    "branch-point": "#5b8c1a",
    "period-doubling": "#c2410c",
    "neimark-sacker": "#7c3aed",
    "hopf": "#7c3aed",
}
BORDER_COLORS = {
    "wall-graze": "#8b5e3c",
    "velocity-graze": "#4b5563",
    "stick": "#a3861a",
    "vanishing-event": "#a21caf",
}
BORDER_COLOR = "#6b6b6b"  # of any other border
HATCHED = "#d9d9d9"
TINTS = ("#dbe9f6", "#fbe3d6", "#e3f1e0", "#efe4f5", "#fdf3cf", "#d9f0f0", "#f6dfe6", "#e9e9e4")
HATCH_LENGTH = 0.012  # of the axes
FITS = 0.9  # share of a name that must lie within its region
AWAY = 5.0  # pixels between a name that was moved and the edges of its region
WIDTH = 14  # characters in a line of the name of a modulation
LEAST_SHARE = 0.012  # regions smaller than this part of the plane are not named


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
    """Draw a chart.

    Parameters
    ----------
    chart : Chart
    labels : bool
        Write the labels of the points of codimension two.
    names : bool
        Write into each region what is stable there.
    axes, legend, style, figsize
        As for :func:`contvines.plots.diagram.plot_diagram`; the legend is usually below a new figure, inside given axes.
    """
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, figsize)
        p, q = chart.parameters
        handles: dict[str, Artist] = {}
        _tint(axes, chart)
        for locus in chart.loci.values():
            _draw(axes, locus, handles)
        axes.set(xlim=chart.within[0], ylim=chart.within[1])
        for locus in chart.loci.values():
            if locus.kind not in COLORS and locus.seed is not None:
                _hatch(axes, locus)
        for point in chart.points.values():
            color = "black" if point.real else "0.6"
            axes.plot(*point.value, "o", color=color, markersize=4, zorder=5)
        across, up = (axis_label(n, unit=chart.units.get(n), notation=chart.notation) for n in (p, q))
        axes.set(xlabel=across, ylabel=up)
        inside = legend == "inside" or (legend is True and not own)
        if not inside:
            place_legend(axes, list(handles.values()), legend, own, usual="below")
        if own and is_low(axes):
            axes.set_ylabel(axis_label(q, short=True, unit=chart.units.get(q), notation=chart.notation))
        settle(figure)
        if own:
            thin_ticks(axes)
            freeze(figure)
        if inside and handles:
            place_legend(axes, list(handles.values()), True, False)
        boxes = hold_legend(axes)
        boxes += _name(axes, chart, boxes) if names else []
        if labels:
            _label(axes, chart, boxes)
    return figure


def _look(locus: Locus) -> dict[str, Any]:
    import matplotlib as mpl

    border = locus.kind not in COLORS
    width = mpl.rcParams["lines.linewidth"]
    return {
        "color": BORDER_COLORS.get(locus.kind, BORDER_COLOR) if border else COLORS[locus.kind],
        "linewidth": width * (0.65 if border else 0.95),
    }


def _draw(axes: Axes, locus: Locus, handles: dict[str, Artist]) -> None:
    values, real = locus.values, locus.real
    solid, dotted = values.copy(), values.copy()
    both = real[:-1] & real[1:]
    solid[~(np.append(both, False) | np.append(False, both))] = np.nan
    dotted[np.append(both, True) & np.append(True, both)] = np.nan
    look, mark = _look(locus), mark_of_locus(locus)
    marked: dict[str, Any] = {"marker": mark.marker, "markersize": 4.0, "markeredgewidth": 0.8}
    marked["markerfacecolor"] = look["color"] if mark.filled else "white"
    marked["markevery"] = (
        0.07,
        0.23,
    )  # of the axes' diagonal: a few on each locus, for those who see no colours
    (line,) = axes.plot(
        dotted[:, 0], dotted[:, 1], label=mark.name, linestyle=":", zorder=3, **{**look, "linewidth": 1.0}
    )
    if np.isfinite(solid).any():  # of a locus that is virtual all along nothing is
        (line,) = axes.plot(solid[:, 0], solid[:, 1], label=mark.name, zorder=3, **look, **marked)
    handles.setdefault(mark.name, line)


def _hatch(axes: Axes, locus: Locus) -> None:
    """Short strokes on the side of a border where its motion cannot be."""
    side = -locus.beyond  # which is told with the second parameter to the right
    if side == 0:
        return
    to_axes = axes.transData - axes.transAxes
    places = to_axes.transform(locus.values)
    gaps = np.diff(places, axis=0)
    sizes = np.hypot(*gaps.T)
    lengths = np.append(0.0, np.cumsum(sizes))
    at = np.arange(0.5 * HATCH_LENGTH, lengths[-1], 1.4 * HATCH_LENGTH)
    i = np.clip(np.searchsorted(lengths, at) - 1, 0, len(gaps) - 1)
    kept = (sizes[i] > 0.0) & np.asarray(locus.real)[i]
    at, i = at[kept], i[kept]
    along = gaps[i] / sizes[i, None]
    here = places[i] + along * (at - lengths[i])[:, None]
    there = here + HATCH_LENGTH * side * np.column_stack([-along[:, 1], along[:, 0]])
    strokes = np.stack([here, there, np.full_like(here, np.nan)], axis=1).reshape(-1, 2)
    look = {"color": _look(locus)["color"], "linewidth": 0.6, "zorder": 2}
    axes.plot(*strokes.T, transform=axes.transAxes, **look)


def _label(axes: Axes, chart: Chart, taken: list[Box]) -> None:
    """Labels of the points, those at one place together, clear of the loci and of the regions' names."""
    import matplotlib as mpl

    wanted = [Label(point.label, *point.value, rank=not point.real) for point in chart.points.values()]
    lines = [dense(axes, locus.values) for locus in chart.loci.values()]
    size = 0.8 * mpl.rcParams["font.size"]
    place_labels(axes, grouped(axes, wanted), np.vstack([np.empty((0, 2)), *lines]), size=size, taken=taken)


def _tint(axes: Axes, chart: Chart) -> None:
    """Tint and hatch the regions, those alike in which the same is stable: distinguished without colours, too."""
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


def _name(axes: Axes, chart: Chart, taken: list[Box]) -> list[Box]:
    """Write into regions what is stable there, where the text has room; the boxes of the texts on the page.

    A name that would stand under the legend stands elsewhere in its region.
    """
    boxes = []
    for region in chart.regions:
        if region.share < LEAST_SHARE or not region.words:
            continue
        for count in (4, 2, 1):  # fewer words where there is little room
            names = [_lines(word) for word in region.words[:count]]
            more = [f"+{len(region.words) - count}"] if len(region.words) > count else []
            more += ["(in part)"] if region.others else []
            look = {"ha": "center", "va": "center", "fontsize": "x-small", "color": "0.25", "zorder": 4}
            text = axes.text(*region.at, "\n".join([*names, *more]), **look)
            if (box := _room_for(axes, chart, region, text, taken)) is not None:
                boxes.append(box)
                break
            text.remove()
    return boxes


def _lines(word: str) -> str:
    return textwrap.fill(word, WIDTH) if word in MODULATIONS else short_word(word, 16)


def _room_for(axes: Axes, chart: Chart, region: Region, text: Text, taken: list[Box]) -> Box | None:
    """Leave or move a text to where it lies within its region and on nothing else; its box on the page, or None."""
    (plo, phi), (qlo, qhi) = chart.within
    places = [(*region.at, 0.0)]
    if region.cells.size:  # and near it in the region, well away from its edges, where that place is taken
        rows, columns = region.cells.shape
        inner = np.argwhere(region.cells)[:: max(1, int(region.cells.sum()) // 200)] + 0.5
        p, q = plo + inner[:, 0] * (phi - plo) / rows, qlo + inner[:, 1] * (qhi - qlo) / columns
        away = np.hypot((p - region.at[0]) / (phi - plo), (q - region.at[1]) / (qhi - qlo))
        places += [(float(p[k]), float(q[k]), AWAY) for k in np.argsort(away)]
    for p, q, pad in places:
        text.set_position((p, q))
        box = text.get_window_extent().padded(pad)
        free = not touching(np.array([box.extents]), np.array(taken).reshape(-1, 4)).any()
        if free and _has_room(axes, chart, region, box, FITS if pad == 0.0 else 1.0):
            return box.extents
    return None


def _has_room(axes: Axes, chart: Chart, region: Region, box: Bbox, share: float) -> bool:
    """Whether a box on the page lies within a region, at least this share of it (its corners may be out)."""
    if not region.cells.size:
        return True
    xs, ys = np.linspace(box.x0, box.x1, 9), np.linspace(box.y0, box.y1, 5)
    places = axes.transData.inverted().transform([(x, y) for x in xs for y in ys])
    (plo, phi), (qlo, qhi) = chart.within
    rows, columns = region.cells.shape
    i = np.floor((places[:, 0] - plo) / (phi - plo) * rows).astype(int)
    j = np.floor((places[:, 1] - qlo) / (qhi - qlo) * columns).astype(int)
    inside = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
    return bool(np.all(inside) and region.cells[i, j].mean() >= share)
