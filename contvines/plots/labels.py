"""Labels that keep clear of curves, of marks and of one another; what finds no clean place is left out and counted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox


Box = tuple[float, float, float, float]

RADII = (7, 11, 16, 24, 34, 46, 62)  # points on the page between an anchor and its text
LEADER = 14  # from this radius on a thin line leads from the text to its anchor
# across and up, and on which side of its anchor a text stands
DIRECTIONS = [
    (float(x), float(y), 0.5 * float(np.sign(round(x, 6))), 0.5 * float(np.sign(round(y, 6))))
    for x, y in ((np.cos(a), np.sin(a)) for a in np.pi * (0.25 + np.arange(16) / 8))
]
CELL = 2.0  # pixels of the raster in which curves are drawn for the search
IMPOSSIBLE = 1e6
WORST = (
    60.0,
    24.0,
)  # cost above which a label is left out: of a point, and of what stands near its place or nowhere
ALONG = 16.0  # half cells of a leader on a curve that count as much as crossing it
EDGE = 1.5  # points between a text and the frame
AS_NEAR = 1.25  # times its distance from its own mark: a text that near to another one could be either's
PLACES = np.linspace(0.0, 1.0, 24)  # along a leader, where it may pass through a box
CROWD = 9  # with more than so many further names at one place none of them says anything


@dataclass(frozen=True)
class Label:
    """A text that belongs to a place.

    Attributes
    ----------
    text : str
    x, y : float
        Data coordinates of what it names.
    color : str
    rank : int
        Smaller ones are placed first; from labels at one place the first few are named.
    kept : bool
        Placed whatever it covers; else left out where no clean place is found.
    near : bool
        Left out rather than put far from its place (names of branches).
    """

    text: str
    x: float
    y: float
    color: str = "black"
    rank: int = 0
    kept: bool = False
    near: bool = False


def place_labels(
    axes: Axes, labels: list[Label], obstacles: np.ndarray, *, size: float, taken: list[Box] | None = None
) -> tuple[list[Any], int]:
    """Write each label where it covers nothing.

    Parameters
    ----------
    axes : drawn on; its limits must be final.
    labels : in any order; places outside the axes are ignored.
    obstacles : float array (n, 2), data coordinates of curves and marks to keep clear of.
    size : font size in points.
    taken : boxes on the page (x0, y0, x1, y1) that no text may touch, such as the legend's.

    Returns
    -------
    artists : list
        The annotations written.
    left_out : int
        How many found no clean place.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    unit = figure.dpi / 72.0
    frame = axes.bbox
    edges: Box = float(frame.x0), float(frame.y0), float(frame.x1), float(frame.y1)
    anchors = axes.transData.transform(np.array([[entry.x, entry.y] for entry in labels]).reshape(-1, 2))
    ground = Ground(frame, axes.transData.transform(np.asarray(obstacles, float).reshape(-1, 2)))
    boxes, leaders, written, left_out = list(taken or ()), [], [], 0
    widths = text_widths({label.text for label in labels}, size)
    marks = [(x - 4 * unit, y - 4 * unit, x + 4 * unit, y + 4 * unit) for x, y in anchors.tolist()]
    for i in sorted(range(len(labels)), key=lambda i: (not labels[i].kept, labels[i].near, labels[i].rank)):
        label, (ax, ay) = labels[i], anchors[i].tolist()
        if not (edges[0] - 1 <= ax <= edges[2] + 1 and edges[1] - 1 <= ay <= edges[3] + 1):
            continue
        width, height = (widths[label.text] + 2) * unit, 1.2 * size * unit
        others = marks[:i] + marks[i + 1 :]
        best: tuple[float, float, float, Box, int] | None = None
        for radius in RADII[:2] if label.near else RADII:
            for dx, dy, right, above in DIRECTIONS:
                cx = ax + (dx * radius + right * width / unit) * unit
                cy = ay + (dy * radius + above * height / unit) * unit
                box = (cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2)
                far = radius >= LEADER
                line = (ax, ay, cx, cy) if far else None
                least = 0.3 * radius + _claimed(box, i, anchors)
                if best is not None and least >= best[0]:
                    continue
                cost = _cost(box, line, edges, ground, boxes, leaders, others, unit) + least
                if best is None or cost < best[0]:
                    best = (cost, cx, cy, box, radius)
            if best is not None and best[0] < RADII[0]:
                break
        assert best is not None
        cost, cx, cy, box, radius = best
        if cost > WORST[label.near] and not label.kept:
            left_out += not label.near
            continue
        boxes.append(box)
        far = radius >= LEADER
        if far:
            leaders.append((ax, ay, cx, cy))
        written.append(_write(axes, label, (ax, ay), (cx, cy), unit, size, far))
    return written, left_out


def grouped(axes: Axes, labels: list[Label], near: float = 9.0, named: int = 3) -> list[Label]:
    """One label for those that lie within `near` points of one another on the page.

    Above `named` names, "+n" stands for n more; where very many lie together, their number stands for all.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    spots = np.array([[entry.x, entry.y] for entry in labels]).reshape(-1, 2)
    screen = axes.transData.transform(spots) * 72.0 / figure.dpi
    groups: list[list[int]] = []
    for i, point in enumerate(screen):
        for group in groups:
            if np.hypot(*(screen[group[0]] - point)) < near and not labels[i].kept:
                group.append(i)
                break
        else:
            groups.append([i])
    found = []
    for group in groups:
        ranked = sorted(group, key=lambda i: labels[i].rank)
        first = labels[ranked[0]]
        names = list(dict.fromkeys(labels[i].text for i in ranked))
        shown = names if len(names) <= named else [*names[: named - 1]]
        more = len(names) - len(shown)
        text = f"{len(names)} points" if more > CROWD else ", ".join(shown) + (f" +{more}" if more else "")
        found.append(Label(text, first.x, first.y, first.color, first.rank, first.kept, first.near))
    return found


def dense(axes: Axes, xy: np.ndarray) -> np.ndarray:
    """Points close together on the page along a line, so that a label cannot slip between two of them."""
    steps = np.nan_to_num(np.hypot(*np.diff(axes.transData.transform(xy), axis=0).T))
    total = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, total[-1], int(np.clip(total[-1] / 1.5, 2, 20000)))
    return np.column_stack([np.interp(at, total, v) for v in xy.T])


def text_widths(texts: set[str], size: float) -> dict[str, float]:
    """How wide texts are, in points, in the font in which they will be written."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font, measure = FontProperties(size=size), TextToPath()
    return {
        text: float(measure.get_text_width_height_descent(text, font, text.count("$") > 1)[0])
        for text in texts
    }


class Ground:
    """How much of a box is covered by curves: sums over a raster of the axes."""

    def __init__(self, frame: Bbox, points: np.ndarray) -> None:
        self.x0, self.y0 = float(frame.x0), float(frame.y0)
        shape = (int(frame.height / CELL) + 2, int(frame.width / CELL) + 2)
        raster = np.zeros(shape)
        points = points[np.isfinite(points).all(axis=1)]
        columns = ((points[:, 0] - self.x0) / CELL).astype(int)
        rows = ((points[:, 1] - self.y0) / CELL).astype(int)
        inside = (rows >= 0) & (rows < shape[0]) & (columns >= 0) & (columns < shape[1])
        raster[rows[inside], columns[inside]] = 1.0
        self.sums = np.zeros((shape[0] + 1, shape[1] + 1))
        self.sums[1:, 1:] = raster.cumsum(0).cumsum(1)

    def covered(self, box: Box) -> float:
        """Cells of the raster with a curve in the box."""
        rows, columns = self.sums.shape
        c0, c1 = (int(min(max((x - self.x0) / CELL, 0), columns - 1)) for x in (box[0], box[2] + CELL))
        r0, r1 = (int(min(max((y - self.y0) / CELL, 0), rows - 1)) for y in (box[1], box[3] + CELL))
        s = self.sums
        return float(s[r1, c1] - s[r0, c1] - s[r1, c0] + s[r0, c0])

    def crossed(self, line: Box) -> float:
        """How many curves a straight line crosses, but for those at its first end; more where it runs along one."""
        rows, columns = self.sums.shape
        count = max(int(np.hypot(line[2] - line[0], line[3] - line[1]) / CELL), 1)
        along = np.linspace(0.0, 1.0, 2 * count)[:, None]
        x, y = (line[:2] + along * np.subtract(line[2:], line[:2])).T
        c = np.clip((x - self.x0) / CELL, 0, columns - 2).astype(int)
        r = np.clip((y - self.y0) / CELL, 0, rows - 2).astype(int)
        s = self.sums
        met = s[r + 1, c + 1] - s[r, c + 1] - s[r + 1, c] + s[r, c] > 0.0
        away = met & (np.cumsum(~met) > 2)  # the anchor lies on a curve of its own
        return float(np.sum(away[1:] & ~away[:-1])) + float(np.sum(away)) / ALONG

    def free(self, boxes: np.ndarray) -> np.ndarray:
        """Which boxes, shape (n, 4), have no curve in them."""
        rows, columns = self.sums.shape
        c0, c1 = (
            (np.clip((x - self.x0) / CELL, 0, columns - 1)).astype(int)
            for x in (boxes[:, 0], boxes[:, 2] + CELL)
        )
        r0, r1 = (
            (np.clip((y - self.y0) / CELL, 0, rows - 1)).astype(int)
            for y in (boxes[:, 1], boxes[:, 3] + CELL)
        )
        s = self.sums
        return s[r1, c1] - s[r0, c1] - s[r1, c0] + s[r0, c0] == 0.0


def _cost(
    box: Box,
    line: Box | None,
    edges: Box,
    ground: Ground,
    boxes: list[Box],
    leaders: list[Box],
    marks: list[Box],
    unit: float,
) -> float:
    out = max(edges[0] - box[0], box[2] - edges[2], edges[1] - box[1], box[3] - edges[3]) + EDGE * unit
    if out > EDGE * unit or any(_overlap(box, other) for other in boxes):
        return IMPOSSIBLE
    cost = (
        10 * max(out, 0.0) / unit
        + 6 * min(ground.covered(box), 40)
        + 25 * sum(_overlap(box, mark) for mark in marks)
    )
    if any(_crosses(other, box) for other in leaders):
        return IMPOSSIBLE
    if line is not None:
        if any(_crosses(line, other) for other in boxes) or any(_meet(line, other) for other in leaders):
            return IMPOSSIBLE
        cost += 8 * sum(_crosses(line, mark) for mark in marks) + 12 * ground.crossed(line)
    return cost


def _write(
    axes: Axes,
    label: Label,
    at: tuple[float, float],
    to: tuple[float, float],
    unit: float,
    size: float,
    far: bool,
) -> Any:
    leader = {"arrowstyle": "-", "color": "0.55", "lw": 0.6, "shrinkA": 1, "shrinkB": 3} if far else None
    return axes.annotate(
        label.text,
        xy=(label.x, label.y),
        xytext=((to[0] - at[0]) / unit, (to[1] - at[1]) / unit),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=size,
        color=label.color,
        arrowprops=leader,
        bbox={"boxstyle": "square,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.75},
        zorder=8,
    )


def _claimed(box: Box, own: int, anchors: np.ndarray) -> float:
    """What it costs that a text stands nearer to something else than to what it names (by its index), or about as near."""
    if len(anchors) < 2:
        return 0.0
    x, y = anchors.T
    across = np.maximum(np.maximum(box[0] - x, x - box[2]), 0.0)
    up = np.maximum(np.maximum(box[1] - y, y - box[3]), 0.0)
    gaps = np.hypot(across, up)
    ours, gaps[own] = float(gaps[own]), np.inf
    nearest = float(gaps.min())
    return 30.0 if nearest < ours - 1.0 else 10.0 if nearest < AS_NEAR * ours else 0.0


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _crosses(line: Box, box: Box) -> bool:
    """Whether a line from (x0, y0) to (x1, y1) passes through a box."""
    xs, ys = line[0] + PLACES * (line[2] - line[0]), line[1] + PLACES * (line[3] - line[1])
    return bool(((xs > box[0]) & (xs < box[2]) & (ys > box[1]) & (ys < box[3])).any())


def _meet(a: Box, b: Box) -> bool:
    """Whether two line segments cross."""

    def side(p: tuple[float, float], line: Box) -> float:
        return (line[2] - line[0]) * (p[1] - line[1]) - (line[3] - line[1]) * (p[0] - line[0])

    return bool(
        side((a[0], a[1]), b) * side((a[2], a[3]), b) < 0.0
        and side((b[0], b[1]), a) * side((b[2], b[3]), a) < 0.0
    )
