"""The graph itself: branches as boxes, switches as arrows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..continuation.settings import hinting
from ..graph.table import short_word
from .figures import Size, Style, freeze, new_axes, settle, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    from ..branches.branch import Branch
    from ..graph.graph import Graph

COLUMNS = 6  # at most, side by side
ASIDE = 0.42  # columns: how far beside its column a bent arrow runs
COMPACT = 0.85  # inches for a box and an arrow where boxes have labels alone
ROW = 0.175  # inches that a row needs there
ALONG = (0.5, 0.64, 0.36, 0.74, 0.26)  # where on its arrow a label may stand, the first free one

Places = dict[str, tuple[float, float]]


@hinting
def plot_network(
    graph: Graph, *, axes: Axes | None = None, figsize: Size = None, style: Style = None
) -> Figure:
    """Draw branches (boxes: label, word, range) from left to right by the number of switches that lead to them.

    A solid box is a real branch, a dotted one a virtual branch; a grey filling says that some of it is stable. After
    `COLUMNS` columns the picture goes on below, from right to left and so on, as one ploughs a field. In a small figure boxes have
    labels alone, and what is too many switches away to find room is left out and counted.

    Parameters
    ----------
    graph : Graph
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; without a size the figure is as large as the graph needs.
    """
    from matplotlib.patches import FancyArrowPatch

    layers = _layers(graph)
    place = _places(layers, COLUMNS)
    wide, low, top = _extent(place)
    needed = (max(4.5, 2.9 * wide), max(2.4, 1.15 * (top - low + 1) + 0.6))
    with styled(style):
        figure, axes = new_axes(axes, figsize or needed)
        extent = axes.get_window_extent()
        across, up = extent.width / figure.dpi, extent.height / figure.dpi
        # boxes with labels alone, as many side by side as leave room for arrows
        compact = across < 0.8 * needed[0] and (figsize is not None or figure.axes != [axes])
        size = 6.0 if compact else 8.0
        if compact:
            columns = int(min(COLUMNS, max(2, across / COMPACT)))
            place = _places(_that_fit(layers, columns, up / ROW), columns)
            wide, low, top = _extent(place)
        axes.set_axis_off()
        boxes = {label: _box(axes, graph.branches[label], at, size, compact) for label, at in place.items()}
        if graph.branches:
            computed = any(branch.stable is not None for branch in graph.branches.values())
            less = len(graph.branches) - len(place)
            further = "" if compact else "; arrows: switches at special points"
            further = f"; {less} more further on" if less else further
            grey = "grey: partly stable" if computed else "stability not computed"
            axes.set_title(f"{grey}; dotted: virtual{further}", fontsize=size)
        aside = (0.15, 0.2) if compact else (0.0, 0.0)
        axes.set(xlim=(-0.5 - aside[0], wide - 0.5 + aside[1]), ylim=(low - 0.6, top + 0.6))
        settle(figure)
        if figure.axes == [axes]:
            freeze(figure)
        taken = [box.get_window_extent() for box in boxes.values()]
        for (source, target), (labels, both) in _pairs(graph).items():
            if source not in place or target not in place:
                continue
            bend = _bend(axes, place, source, target)
            around = {"patchA": boxes[source].get_bbox_patch(), "patchB": boxes[target].get_bbox_patch()}
            look = {"mutation_scale": 10, "color": "0.35", "linewidth": 0.9, "zorder": 1, **around}
            look |= {"arrowstyle": "<|-|>" if both else "-|>", "connectionstyle": f"arc3,rad={bend}"}
            axes.add_patch(FancyArrowPatch(place[source], place[target], **look))
            beside = compact and bend == 0.0 and place[source][0] == place[target][0]  # a short arrow
            look = {"ha": "left" if beside else "center", "va": "center", "fontsize": size, "zorder": 4}
            white = {"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none"}
            written = axes.text(0.0, 0.0, ", ".join(labels), bbox=white, **look)
            ends = axes.transData.transform([place[source], place[target]])
            _stand(written, axes, ends, bend, 0.06 if beside else 0.0, taken)
    return figure


def _box(axes: Axes, branch: Branch, at: tuple[float, float], size: float, compact: bool) -> Text:
    some = branch.stable is not None and bool(branch.stable.any()) and branch.real
    look = {"boxstyle": "round,pad=0.45", "ec": "black", "lw": 1.0}
    look |= {"fc": "0.90" if some else "white", "ls": "-" if branch.real else ":"}
    text = branch.label if compact else _caption(branch)
    return axes.text(*at, text, ha="center", va="center", fontsize=size, bbox=look)


def _stand(written: Text, axes: Axes, ends: np.ndarray, bend: float, aside: float, taken: list[Bbox]) -> None:
    """Put a label on its arrow where it covers no box and no other label, else in the arrow's middle."""
    (dx, dy), found = ends[1] - ends[0], []
    corner = ends.mean(axis=0) + bend * np.array([dy, -dx])
    for t in ALONG:
        on = (1 - t) ** 2 * ends[0] + 2 * t * (1 - t) * corner + t**2 * ends[1]
        x, y = axes.transData.inverted().transform(on)
        written.set_position((x + aside, y))
        box = written.get_window_extent()
        found.append((any(box.overlaps(other) for other in taken), len(found), (x + aside, y), box))
    _, _, position, box = min(found, key=lambda entry: entry[:2])
    written.set_position(position)
    taken.append(box)


def _that_fit(layers: list[list[str]], columns: int, rows: float) -> list[list[str]]:
    """The first layers, as many as find room in so many rows; of a single one that does not, the first labels."""
    for count in range(len(layers), 0, -1):
        _, low, top = _extent(_places(layers[:count], columns))
        if top - low + 1 <= rows:
            return layers[:count]
    return [layers[0][: max(int(rows), 1)]] if layers else []


def _pairs(graph: Graph) -> dict[tuple[str, str], tuple[list[str], bool]]:
    """By the two branches that switches tie: at which points, and whether they were found both ways."""
    pairs: dict[tuple[str, str], tuple[list[str], bool]] = {}
    for switch in graph.switches:
        key, back = (switch.source, switch.target), (switch.target, switch.source)
        if key[0] == key[1] or not all(label in graph.branches for label in key):
            continue
        known = back if back in pairs else key
        labels, both = pairs.get(known, ([], False))
        more = [] if switch.point in labels else [switch.point]
        pairs[known] = [*labels, *more], both or known == back
    return pairs


def _bend(axes: Axes, place: Places, source: str, target: str) -> float:
    """Curvature of an arrow: straight, unless it would run behind a box between its ends."""
    one, two = np.array(place[source]), np.array(place[target])
    (dx, dy), (ax, _) = two - one, one
    for label, at in place.items():
        if label in (source, target):
            continue
        share = (at[1] - one[1]) / dy if dx == 0.0 else (at[0] - ax) / dx
        if 0 < share < 1 and np.all(np.abs(one + share * (two - one) - at) < 0.3):
            if dx != 0.0:
                return 0.3
            # beside its own column, at the edge of the picture if that is near
            outside = 1.0 if ax > 0 and ax == max(x for x, _ in place.values()) else -1.0
            across, up = np.abs(axes.transData.transform((1.0, dy)) - axes.transData.transform((0.0, 0.0)))
            return float(outside * 2.0 * ASIDE * across / up * np.sign(dy))
    return 0.0


def _extent(place: Places) -> tuple[int, float, float]:
    """How many columns there are, the lowest and the highest row."""
    x, y = np.array([*place.values()] or [(0.0, 0.0)]).T
    return round(x.max()) + 1, float(y.min()), float(y.max())


def _layers(graph: Graph) -> list[list[str]]:
    """Labels by the number of switches that lead to them, each layer in the graph's order."""
    depth: dict[str, int] = {}
    for label in graph.branches:
        front = [] if label in depth else [label]
        depth.setdefault(label, 0)
        while front:
            pairs = [(s.source, s.target) for s in graph.switches if s.source in front]
            found = {t: depth[s] + 1 for s, t in pairs if t in graph.branches and t not in depth}
            depth |= found
            front = list(found)
    layers: list[list[str]] = [[] for _ in range(max(depth.values(), default=-1) + 1)]
    for label in graph.branches:
        layers[depth[label]].append(label)
    return layers


def _places(layers: list[list[str]], columns: int) -> Places:
    """Where each box stands: layers as columns, so many of them in a band, the bands below one another."""
    place: Places = {}
    middle = 0.0
    for first in range(0, len(layers), columns):
        band = layers[first : first + columns]
        half = (max(map(len, band)) - 1) / 2
        middle -= half if first else 0.0
        back = first // columns % 2 == 1
        for column, labels in enumerate(band):
            for i, label in enumerate(labels):
                px = columns - 1 - column if back else column
                place[label] = (float(px), middle - (i - (len(labels) - 1) / 2))
        middle -= half + 1.0
    return place


def _range(low: float, high: float) -> str:
    """Two numbers with as many digits as tell them apart, at least four."""
    for digits in range(4, 17):
        texts = f"{low:.{digits}g}", f"{high:.{digits}g}"
        if texts[0] != texts[1]:
            return " to ".join(texts)
    return f"{low:.4g}"


def _caption(branch: Branch) -> str:
    about = branch.description
    word = short_word(about["word"] or about.get("name", ""), 18) if "word" in about else ""
    periods = about.get("periods")
    cycles = f"  k={periods}" if periods else ""
    what = f"  {word}" if word else ""
    return f"{branch.label}{what}{cycles}\n{branch.parameter} {_range(*branch.range)}"
