"""A chart: loci by kind, borders hatched where the motion ends, regions tinted and named, points of codimension two."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .figures import new_axes, styled
from .style import MARKS, PLAIN

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..loci.chart import Chart
    from ..loci.locus import Locus

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
    "chatter": "#a21caf",
}
BORDER_COLOR = "#6b6b6b"  # of any other border
TINTS = ("#dbe9f6", "#fbe3d6", "#e3f1e0", "#efe4f5", "#fdf3cf", "#d9f0f0", "#f6dfe6", "#e9e9e4")
HATCH_LENGTH = 0.012  # of the axes
LEAST_SHARE = 0.012  # regions smaller than this part of the plane are not named


def plot_chart(
    chart: Chart,
    axes: Any = None,
    labels: bool = True,
    names: bool = True,
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
    style : str or mapping, optional
        As for :func:`contvines.plots.figures.styled`.
    **options
        For the new figure (``figsize``).

    Returns
    -------
    matplotlib Figure
    """
    with styled(style):
        figure, axes = new_axes(axes, **options)
        p, q = chart.parameters
        (plo, phi), (qlo, qhi) = chart.within
        handles: dict[str, Any] = {}
        _tint(axes, chart)
        for locus in chart.loci.values():
            _draw(axes, locus, handles)
        axes.set_xlim(qlo, qhi)
        axes.set_ylim(plo, phi)
        for locus in chart.loci.values():
            if locus.kind not in COLORS and locus.seed is not None:
                _hatch(axes, locus)
        for point in chart.points.values():
            axes.plot(
                point.value[1],
                point.value[0],
                "o",
                color="black" if point.real else "0.6",
                markersize=4,
                zorder=5,
            )
        if labels:
            _label(axes, chart)
        if names:
            _name(axes, chart)
        unit = chart.units
        axes.set_xlabel(q + (f" [{unit[q]}]" if unit.get(q) else ""))
        axes.set_ylabel(p + (f" [{unit[p]}]" if unit.get(p) else ""))
        axes.legend(
            handles=list(handles.values()),
            loc="upper center",
            bbox_to_anchor=(0.5, -0.13),
            ncol=3,
            fontsize="small",
        )
        figure.set_layout_engine("constrained")
    return figure


def _look(locus: Locus) -> dict[str, Any]:
    border = locus.kind not in COLORS
    return {
        "color": BORDER_COLORS.get(locus.kind, BORDER_COLOR) if border else COLORS[locus.kind],
        "linewidth": 1.1 if border else 1.6,
    }


def _draw(axes: Any, locus: Locus, handles: dict[str, Any]) -> None:
    values, real = locus.values, locus.real
    solid, dotted = values.copy(), values.copy()
    both = real[:-1] & real[1:]
    solid[~(np.append(both, False) | np.append(False, both))] = np.nan
    dotted[np.append(both, True) & np.append(True, both)] = np.nan
    look, name = _look(locus), MARKS.get(locus.kind, PLAIN).name
    (line,) = axes.plot(solid[:, 1], solid[:, 0], label=name, zorder=3, **look)
    axes.plot(dotted[:, 1], dotted[:, 0], linestyle=":", zorder=3, **{**look, "linewidth": 1.0})
    handles.setdefault(name, line)


def _hatch(axes: Any, locus: Locus) -> None:
    """Short strokes on the side of a border where its motion cannot be."""
    side = locus.beyond
    if side == 0:
        return
    to_axes = axes.transData + axes.transAxes.inverted()
    places = to_axes.transform(locus.values[:, ::-1])
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


def _label(axes: Any, chart: Chart) -> None:
    """Labels of the points, those at one place together."""
    places: dict[tuple[float, float], list[str]] = {}
    for point in chart.points.values():
        place = (float(f"{point.value[1]:.6g}"), float(f"{point.value[0]:.6g}"))
        places.setdefault(place, []).append(point.label)
    for i, (place, names) in enumerate(sorted(places.items())):
        above = i % 2 == 0  # neighbours on one curve get out of each other's way
        axes.annotate(
            ", ".join(names),
            place,
            textcoords="offset points",
            xytext=(-2, 7) if above else (2, -11),
            ha="center",
            fontsize="x-small",
            zorder=6,
        )


def _tint(axes: Any, chart: Chart) -> None:
    (plo, phi), (qlo, qhi) = chart.within
    seen: dict[tuple[str, ...], str] = {}
    for region in chart.regions:
        key = tuple(sorted(region.words))
        color = seen.setdefault(key, TINTS[len(seen) % len(TINTS)])
        if not region.cells.size:
            continue
        from matplotlib.colors import to_rgb

        picture = np.zeros((*region.cells.shape, 4))
        picture[..., :3] = to_rgb(color)
        picture[..., 3] = region.cells
        axes.imshow(
            picture,
            origin="lower",
            extent=(qlo, qhi, plo, phi),
            aspect="auto",
            interpolation="nearest",
            zorder=0,
        )


def _name(axes: Any, chart: Chart) -> None:
    for region in chart.regions:
        if region.share < LEAST_SHARE or not region.words:
            continue
        text = "\n".join(word if len(word) <= 16 else f"{word[:13]}..." for word in region.words[:4])
        axes.text(
            region.at[1],
            region.at[0],
            text,
            ha="center",
            va="center",
            fontsize="x-small",
            color="0.25",
            zorder=4,
        )
