"""A chart: loci by kind, borders hatched where the motion ends, regions tinted and named, points of codimension two."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.hints import hinting
from ..graph.shortening import short_word
from .figures import freeze, new_axes, settle, styled, thin_ticks
from .labels import Box, Label, dense, grouped, place_labels
from .legends import hold_legend, place_legend
from .style import MARKS, PLAIN, axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

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
HATCHES = (None, "////", "....", "\\\\\\\\", "----", "xxxx", "||||", "++++")
HATCHED = "#d9d9d9"
TINTS = ("#dbe9f6", "#fbe3d6", "#e3f1e0", "#efe4f5", "#fdf3cf", "#d9f0f0", "#f6dfe6", "#e9e9e4")
HATCH_LENGTH = 0.012  # of the axes
FITS = 0.9  # share of a name that must lie within its region
AWAY = 5.0  # pixels between a name that was moved and the edges of its region
LOW = 2.6  # inches: lower axes have the symbol of a parameter alone at their side
LEAST_SHARE = 0.012  # regions smaller than this part of the plane are not named


@hinting
def plot_chart(
    chart: Chart,
    axes: Axes | None = None,
    labels: bool = True,
    names: bool = True,
    legend: bool | str = True,
    style: str | Mapping[str, Any] | None = None,
    **options: Any,
) -> Figure:
    """Draw a chart.

    Parameters
    ----------
    chart : Chart
    axes : matplotlib axes, optional
    labels : bool
        Write the labels of the points of codimension two.
    names : bool
        Write into each region what is stable there.
    legend : bool or str
        Say what the lines are: below a new figure, inside given axes; or where, as in
        :func:`contvines.plots.diagram.plot_diagram`.
    style : str or mapping, optional
        As for :func:`contvines.plots.figures.styled`.
    **options
        For the new figure (``figsize``).

    Returns
    -------
    matplotlib Figure
    """
    own = axes is None
    with styled(style):
        figure, axes = new_axes(axes, **options)
        p, q = chart.parameters
        (plo, phi), (qlo, qhi) = chart.within
        handles: dict[str, Any] = {}
        _tint(axes, chart)
        for locus in chart.loci.values():
            _draw(axes, locus, handles)
        axes.set_xlim(plo, phi)
        axes.set_ylim(qlo, qhi)
        for locus in chart.loci.values():
            if locus.kind not in COLORS and locus.seed is not None:
                _hatch(axes, locus)
        for point in chart.points.values():
            axes.plot(
                point.value[0],
                point.value[1],
                "o",
                color="black" if point.real else "0.6",
                markersize=4,
                zorder=5,
            )
        axes.set_xlabel(axis_label(p, unit=chart.units.get(p), notation=chart.notation))
        axes.set_ylabel(axis_label(q, unit=chart.units.get(q), notation=chart.notation))
        inside = legend == "inside" or (legend is True and not own)
        if not inside:
            place_legend(axes, list(handles.values()), legend, own, usual="below")
        settle(figure)
        if own and axes.get_window_extent().height < LOW * figure.dpi:
            axes.set_ylabel(axis_label(q, short=True, unit=chart.units.get(q), notation=chart.notation))
            settle(figure)
        settle(figure)  # the labels of the axes have their size by now
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


def _draw(axes: Axes, locus: Locus, handles: dict[str, Any]) -> None:
    values, real = locus.values, locus.real
    solid, dotted = values.copy(), values.copy()
    both = real[:-1] & real[1:]
    solid[~(np.append(both, False) | np.append(False, both))] = np.nan
    dotted[np.append(both, True) & np.append(True, both)] = np.nan
    look, mark = _look(locus), MARKS.get(locus.kind, PLAIN)
    marked = {
        "marker": mark.marker,
        "markevery": (
            0.07,
            0.23,
        ),  # of the axes' diagonal: a few marks on each locus, for those who see no colours
        "markersize": 4.0,
        "markerfacecolor": look["color"] if mark.filled else "white",
        "markeredgewidth": 0.8,
    }
    name = mark.name
    (line,) = axes.plot(solid[:, 0], solid[:, 1], label=name, zorder=3, **look, **marked)
    axes.plot(dotted[:, 0], dotted[:, 1], linestyle=":", zorder=3, **{**look, "linewidth": 1.0})
    handles.setdefault(name, line)


def _hatch(axes: Axes, locus: Locus) -> None:
    """Short strokes on the side of a border where its motion cannot be."""
    side = -locus.beyond  # which is told with the second parameter to the right
    if side == 0:
        return
    to_axes = axes.transData + axes.transAxes.inverted()
    places = to_axes.transform(locus.values)
    lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(places, axis=0).T)))
    if not lengths[-1] > 0.0:
        return
    for s in np.arange(0.5 * HATCH_LENGTH, lengths[-1], 1.4 * HATCH_LENGTH):
        i = int(np.clip(np.searchsorted(lengths, s) - 1, 0, len(places) - 2))
        gap = places[i + 1] - places[i]
        size = float(np.hypot(*gap))
        if size == 0.0 or not locus.real[i]:
            continue
        here = places[i] + gap * (s - lengths[i]) / size
        across = side * np.array([-gap[1], gap[0]]) / size
        end = here + HATCH_LENGTH * across
        axes.plot(
            [here[0], end[0]],
            [here[1], end[1]],
            transform=axes.transAxes,
            color=_look(locus)["color"],
            linewidth=0.6,
            zorder=2,
        )


def _label(axes: Axes, chart: Chart, taken: list[Any]) -> None:
    """Labels of the points, those at one place together, clear of the loci and of the regions' names."""
    import matplotlib as mpl

    wanted = [Label(point.label, *point.value, rank=not point.real) for point in chart.points.values()]
    lines = [dense(axes, locus.values) for locus in chart.loci.values()]
    size = 0.8 * mpl.rcParams["font.size"]
    place_labels(axes, grouped(axes, wanted), np.vstack([np.empty((0, 2)), *lines]), size=size, taken=taken)


def _tint(axes: Axes, chart: Chart) -> None:
    """Tint and hatch the regions, those alike in which the same is stable: told apart without colours, too."""
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
            names = [short_word(word, 16) for word in region.words[:count]]
            more = [f"+{len(region.words) - count}"] if len(region.words) > count else []
            more += ["(in part)"] if region.others else []
            look = {"ha": "center", "va": "center", "fontsize": "x-small", "color": "0.25", "zorder": 4}
            text = axes.text(*region.at, "\n".join([*names, *more]), **look)
            if (box := _room_for(axes, chart, region, text, taken)) is not None:
                boxes.append(box)
                break
            text.remove()
    return boxes


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
        free = not any(
            box.x0 < x1 and x0 < box.x1 and box.y0 < y1 and y0 < box.y1 for x0, y0, x1, y1 in taken
        )
        if free and _has_room(axes, chart, region, box, FITS if pad == 0.0 else 1.0):
            return box.x0, box.y0, box.x1, box.y1
    return None


def _has_room(axes: Axes, chart: Chart, region: Region, box: Any, share: float) -> bool:
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
