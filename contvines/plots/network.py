"""Picture of the connections of a graph: branches as boxes, switches as arrows."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from ..branches import Branch
from ..continuation.settings import hinting
from ..graph import Graph
from ..graph.table import short_word
from ..shared.figures import Size, Style, drawing, finish_layout
from ..shared.numbers import figures
from .labels import Raster

COLUMNS = 6  # largest number of columns side by side
ASIDE = 0.42  # in widths of a column: distance of a bent arrow from the middle of its column
COMPACT = 0.85  # inches: width of a column in a small figure, whose boxes have labels only
ROW = 0.175  # inches: height of a row in a small figure
ALONG = (0.5, 0.64, 0.36, 0.74, 0.26)  # relative to an arrow: positions of its label that are tried

Places = dict[str, tuple[float, float]]


@hinting
def plot_network(
    graph: Graph, *, axes: Axes | None = None, figsize: Size = None, style: Style = None
) -> Figure:
    """Draw branches (boxes: label, word, range) from left to right by the number of switches that lead to them.

    Solid boxes are real branches, dotted ones virtual branches; branches with stable parts are grey. After `COLUMNS` columns the
    picture goes on below, from right to left, then again from left to right. In a small figure boxes have labels only; branches that
    find no room are left out, and the title gives their number.

    Parameters
    ----------
    graph : Graph
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; by default the size depends on the number of branches.
    """
    layers = _layers(graph)
    place = _places(layers, COLUMNS)
    x, y = np.array([*place.values()] or [(0.0, 0.0)]).T
    needed = (max(4.5, 2.9 * (x.max() + 1.0)), max(2.4, 1.15 * (np.ptp(y) + 1.0) + 0.6))
    with drawing(axes, style, figsize or needed) as (figure, axes, own):
        across, up = np.array(axes.bbox.size) / figure.dpi
        # boxes with labels only; as many columns as leave room for arrows
        compact = across < 0.8 * needed[0] and (figsize is not None or not own)
        size = 6.0 if compact else 8.0
        if compact:
            place = _places(layers, int(min(COLUMNS, max(2, across / COMPACT))))
            place = {label: at for label, at in place.items() if at[1] >= 1.0 - up / ROW}
        boxes = {label: _box(axes, graph.branches[label], at, size, compact) for label, at in place.items()}
        if graph.branches:
            computed = any(branch.stable is not None for branch in graph.branches.values())
            less = len(graph.branches) - len(place)
            further = "" if compact else "; arrows: switches at special points"
            further = f"; {less} more further on" if less else further
            grey = "grey: partly stable" if computed else "stability not computed"
            axes.set_title(f"{grey}; dotted: virtual{further}", fontsize=size)
        axes.set_axis_off()
        x, y = np.array([*place.values()] or [(0.0, 0.0)]).T
        aside = (0.15, 0.2) if compact else (0.0, 0.0)
        axes.set(xlim=(-0.5 - aside[0], x.max() + 0.5 + aside[1]), ylim=(y.min() - 0.6, y.max() + 0.6))
        finish_layout(figure, own)
        for (source, target), (labels, both) in _pairs(graph).items():
            if source not in place or target not in place:
                continue
            bend = _bend(axes, place, source, target)
            around = {"patchA": boxes[source].get_bbox_patch(), "patchB": boxes[target].get_bbox_patch()}
            look = {"mutation_scale": 10, "color": "0.35", "linewidth": 0.9, **around}
            look["zorder"] = 3.5  # after the boxes, whose sizes on the page are known when they are drawn
            look |= {"arrowstyle": "<|-|>" if both else "-|>", "connectionstyle": f"arc3,rad={bend}"}
            axes.add_patch(FancyArrowPatch(place[source], place[target], **look))
            beside = compact and bend == 0.0 and place[source][0] == place[target][0]  # a short arrow
            ends = axes.transData.transform([place[source], place[target]])
            _write(axes, ", ".join(labels), ends, bend, size, 0.06 if beside else 0.0)
    return figure


def _box(axes: Axes, branch: Branch, at: tuple[float, float], size: float, compact: bool) -> Text:
    some = branch.stable is not None and bool(branch.stable.any()) and branch.real
    look = {"boxstyle": "round,pad=0.45", "ec": "black", "lw": 1.0}
    look |= {"fc": "0.90" if some else "white", "ls": "-" if branch.real else ":"}
    text = branch.label if compact else _caption(branch)
    return axes.text(*at, text, ha="center", va="center", fontsize=size, bbox=look)


def _write(axes: Axes, text: str, ends: np.ndarray, bend: float, size: float, aside: float) -> None:
    """Write a label on its arrow where it covers neither a box nor another label, else in the middle of the arrow."""
    raster, white = Raster(axes), {"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none"}
    look = {"ha": "left" if aside else "center", "va": "center", "fontsize": size, "bbox": white, "zorder": 4}
    written = axes.text(0.0, 0.0, text, **look)
    (dx, dy), t = ends[1] - ends[0], np.array(ALONG)[:, None]
    corner = ends.mean(axis=0) + bend * np.array([dy, -dx])
    on = (1 - t) ** 2 * ends[0] + 2 * t * (1 - t) * corner + t**2 * ends[1]
    places = axes.transData.inverted().transform(on) + [aside, 0.0]
    for place in (*places, places[0]):
        written.set_position(tuple(place))
        if raster.covered(written.get_window_extent().extents)[0] == 0.0:
            break


def _pairs(graph: Graph) -> dict[tuple[str, str], tuple[list[str], bool]]:
    """Return (source, target) -> labels of the points that connect them, and whether switches were found in both directions."""
    pairs: dict[tuple[str, str], tuple[list[str], bool]] = {}
    for switch in graph.switches:
        key, back = (switch.source, switch.target), (switch.target, switch.source)
        if key[0] != key[1]:
            ends = back if back in pairs else key
            labels, both = pairs.get(ends, ([], False))
            pairs[ends] = list(dict.fromkeys([*labels, switch.point])), both or ends == back
    return pairs


def _bend(axes: Axes, place: Places, source: str, target: str) -> float:
    """Return the curvature of an arrow: 0 unless a box lies between its ends."""
    one, two = np.array(place[source]), np.array(place[target])
    (dx, dy), (ax, _) = two - one, one
    for label, at in place.items():
        if label in (source, target):
            continue
        share = (at[1] - one[1]) / dy if dx == 0.0 else (at[0] - ax) / dx
        if 0 < share < 1 and np.all(np.abs(one + share * (two - one) - at) < 0.3):
            if dx != 0.0:
                return 0.3
            # around the boxes of its column: on the right in the last column, else on the left
            outside = 1.0 if ax > 0 and ax == max(x for x, _ in place.values()) else -1.0
            across, up = np.abs(axes.transData.transform((1.0, dy)) - axes.transData.transform((0.0, 0.0)))
            return float(outside * 2.0 * ASIDE * across / up * np.sign(dy))
    return 0.0


def _layers(graph: Graph) -> list[list[str]]:
    """Return the labels of branches in layers, by the number of switches that lead to them; each layer in the order of the graph."""
    depth: dict[str, int] = {}
    for label in graph.branches:
        front = set() if label in depth else {label}
        steps = 0
        while front:
            depth |= dict.fromkeys(front, steps)
            reached = {s.target for s in graph.switches if s.source in front and s.target in graph.branches}
            front, steps = reached - set(depth), steps + 1
    return [
        [label for label in graph.branches if depth[label] == k]
        for k in range(max(depth.values(), default=-1) + 1)
    ]


def _places(layers: list[list[str]], columns: int) -> Places:
    """Return the position of each box: layers are columns, `columns` of them form a band, and bands lie below one another."""
    place: Places = {}
    top = 0
    for first in range(0, len(layers), columns):
        band = layers[first : first + columns]
        height = max(map(len, band))
        for column, labels in enumerate(band):
            px = columns - 1 - column if first // columns % 2 else column
            for i, label in enumerate(labels):
                place[label] = float(px), top - 0.5 * (height - len(labels)) - i
        top -= height
    return place


def _caption(branch: Branch) -> str:
    about = branch.description
    word = short_word(about["word"] or about.get("name", ""), 18) if "word" in about else ""
    periods = about.get("periods")
    named = "  ".join([branch.label, *filter(None, [word, f"k={periods}" if periods else ""])])
    span = " to ".join(dict.fromkeys(figures(end, float(np.ptp(branch.range))) for end in branch.range))
    return f"{named}\n{branch.parameter} {span}"
