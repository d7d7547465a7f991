"""The graph itself: branches as boxes, switches as arrows."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.hints import hinting
from ..graph.shortening import short_word
from .figures import freeze, new_axes, settle, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

    from ..branches.branch import Branch
    from ..graph.graph import Graph

COLUMNS = 6  # at most, side by side
ASIDE = 0.42  # columns: how far beside its column a bent arrow runs
COMPACT = 0.85  # inches for a box and an arrow where boxes have labels alone
ROW = 0.175  # inches that a row needs there
ALONG = (0.5, 0.64, 0.36, 0.74, 0.26)  # where on its arrow a label may stand, the first free one


@hinting
def plot_network(
    graph: "Graph",
    *,
    axes: "Axes | None" = None,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> "Figure":
    """Draw branches (boxes: label, word, range) from left to right by the number of switches that lead to them.

    A solid box is a real branch, a dotted one a virtual branch; a grey filling says that some of it is stable. After
    `COLUMNS` columns the picture goes on below, from right to left and so on, as one ploughs a field. In a small figure boxes have
    labels alone, and what is too many switches away to find room is left out and counted.

    Parameters
    ----------
    graph : Graph
    axes : Axes, optional
        Drawn on; without, a new figure that is as large as the graph needs, or `figsize` (inches).
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the package's.
    """
    from matplotlib.patches import FancyArrowPatch

    layers = _layers(graph)
    place = _places(layers, COLUMNS)
    wide = round(max((px for px, _ in place.values()), default=0.0)) + 1
    low, top = _ends(place)
    needed = (max(4.5, 2.9 * wide), max(2.4, 1.15 * (top - low + 1) + 0.6))
    with styled(style):
        figure, axes = new_axes(axes, figsize=figsize or needed)
        extent = axes.get_window_extent()
        inches = extent.width / figure.dpi
        # boxes with labels alone, as many side by side as leave room for arrows
        compact = inches < 0.8 * needed[0] and (figsize is not None or figure.axes != [axes])
        size = 8.0 if not compact else 6.0
        if compact:
            columns = int(min(COLUMNS, max(2, inches / COMPACT)))
            place = _places(_that_fit(layers, columns, extent.height / figure.dpi / ROW), columns)
            wide = round(max((px for px, _ in place.values()), default=0.0)) + 1
            low, top = _ends(place)
        axes.set_axis_off()
        boxes: dict[str, Any] = {}
        for label, (px, py) in place.items():
            branch = graph.branches[label]
            some = branch.stable is not None and bool(branch.stable.any()) and branch.real
            style = {
                "fc": "0.90" if some else "white",
                "ec": "black",
                "ls": "-" if branch.real else ":",
                "lw": 1.0,
            }
            boxes[label] = axes.text(
                px,
                py,
                branch.label if compact else _caption(branch),
                ha="center",
                va="center",
                fontsize=size,
                bbox={"boxstyle": "round,pad=0.45", **style},
            )
        if graph.branches:
            computed = any(branch.stable is not None for branch in graph.branches.values())
            told = f"{'grey: partly stable' if computed else 'stability not computed'}; dotted: virtual"
            less = len(graph.branches) - len(place)
            more = (
                f"; {less} more further on"
                if less
                else ""
                if compact
                else "; arrows: switches at special points"
            )
            axes.set_title(f"{told}{more}", fontsize=size)
        axes.set_xlim(-0.5 - (0.15 if compact else 0.0), wide - 0.5 + (0.2 if compact else 0.0))
        axes.set_ylim(low - 0.6, top + 0.6)
        settle(figure)
        if figure.axes == [axes]:
            freeze(figure)
        taken = [box.get_window_extent() for box in boxes.values()]
        for pair, switches in _pairs(graph).items():
            source, target = pair
            if source not in place or target not in place:
                continue
            both = len({(s.source, s.target) for s in switches}) > 1
            bend = _bend(axes, place, source, target)
            arrow = FancyArrowPatch(
                place[source],
                place[target],
                patchA=boxes[source].get_bbox_patch(),
                patchB=boxes[target].get_bbox_patch(),
                connectionstyle=f"arc3,rad={bend}",
                arrowstyle="<|-|>" if both else "-|>",
                mutation_scale=10,
                color="0.35",
                linewidth=0.9,
                zorder=1,
            )
            axes.add_patch(arrow)
            beside = compact and bend == 0.0 and place[source][0] == place[target][0]  # a short arrow
            written = axes.text(
                0.0,
                0.0,
                ", ".join(dict.fromkeys(s.point for s in switches)),
                ha="left" if beside else "center",
                va="center",
                fontsize=size,
                bbox={"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none"},
                zorder=4,
            )
            ends = axes.transData.transform([place[source], place[target]])
            _stand(written, axes, ends, bend, 0.06 if beside else 0.0, taken)
    return figure


def _stand(
    written: "Text", axes: "Axes", ends: np.ndarray, bend: float, aside: float, taken: list[Any]
) -> None:
    """Put a label on its arrow where it covers no box and no other label, else in the arrow's middle."""
    (ax, ay), (bx, by) = ends
    corner = np.array([(ax + bx) / 2 + bend * (by - ay), (ay + by) / 2 - bend * (bx - ax)])
    found = []
    for t in ALONG:
        on = (1 - t) ** 2 * ends[0] + 2 * t * (1 - t) * corner + t**2 * ends[1]
        tx, ty = axes.transData.inverted().transform(on)
        written.set_position((tx + aside, ty))
        box = written.get_window_extent()
        found.append((any(box.overlaps(other) for other in taken), len(found), (tx + aside, ty), box))
    _, _, position, box = min(found, key=lambda entry: entry[:2])
    written.set_position(position)
    taken.append(box)


def _that_fit(layers: list[list[str]], columns: int, rows: float) -> list[list[str]]:
    """The first layers, as many as find room in so many rows; of a single one that does not, the first labels."""
    for count in range(len(layers), 0, -1):
        low, top = _ends(_places(layers[:count], columns))
        if top - low + 1 <= rows:
            return layers[:count]
    return [layers[0][: max(int(rows), 1)]] if layers else []


def _pairs(graph: "Graph") -> dict[tuple[str, str], list[Any]]:
    """Switches by the two branches that they tie, whichever way they were found."""
    pairs: dict[tuple[str, str], list[Any]] = {}
    for switch in graph.switches:
        source, target = switch.source, switch.target
        if source in graph.branches and target in graph.branches and source != target:
            key = (target, source) if (target, source) in pairs else (source, target)
            pairs.setdefault(key, []).append(switch)
    return pairs


def _bend(axes: "Axes", place: dict[str, tuple[float, float]], source: str, target: str) -> float:
    """Curvature of an arrow: straight, unless it would run behind a box between its ends."""
    (ax, ay), (bx, by) = place[source], place[target]
    for label, (px, py) in place.items():
        if label in (source, target):
            continue
        share = (py - ay) / (by - ay) if ax == bx else (px - ax) / (bx - ax)
        if (
            0 < share < 1
            and abs(ax + share * (bx - ax) - px) < 0.3
            and abs(ay + share * (by - ay) - py) < 0.3
        ):
            if ax != bx:
                return 0.3
            # beside its own column, at the edge of the picture if that is near
            outside = 1.0 if ax > 0 and ax == max(x for x, _ in place.values()) else -1.0
            across, up = np.abs(
                axes.transData.transform((1.0, by - ay)) - axes.transData.transform((0.0, 0.0))
            )
            return outside * 2.0 * ASIDE * across / up * (1.0 if by > ay else -1.0)
    return 0.0


def _ends(place: dict[str, tuple[float, float]]) -> tuple[float, float]:
    """The lowest and the highest row."""
    low, top = (edge((py for _, py in place.values()), default=0.0) for edge in (min, max))
    return low, top


def _layers(graph: "Graph") -> list[list[str]]:
    """Labels by the number of switches that lead to them, each layer in the graph's order."""
    depth: dict[str, int] = {}
    for label in graph.branches:
        if label in depth:
            continue
        front = [label]
        depth[label] = 0
        while front:
            found = []
            for switch in graph.switches:
                if switch.source in front and switch.target in graph.branches and switch.target not in depth:
                    depth[switch.target] = depth[switch.source] + 1
                    found.append(switch.target)
            front = found
    layers: list[list[str]] = [[] for _ in range(max(depth.values(), default=-1) + 1)]
    for label in graph.branches:
        layers[depth[label]].append(label)
    return layers


def _places(layers: list[list[str]], columns: int) -> dict[str, tuple[float, float]]:
    """Where each box stands: layers as columns, so many of them in a band, the bands below one another."""
    place: dict[str, tuple[float, float]] = {}
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


def _caption(branch: "Branch") -> str:
    about = branch.description
    word = short_word(about["word"] or about.get("name", ""), 18) if "word" in about else ""
    periods = branch.description.get("periods")
    what = f"  {word}" if word else ""
    cycles = f"  k={periods}" if periods else ""
    low, high = branch.range
    return f"{branch.label}{what}{cycles}\n{branch.parameter} {_range(low, high)}"
