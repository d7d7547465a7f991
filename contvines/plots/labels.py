"""Placement of labels and insets between curves and marks; labels without a free place are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.inset import InsetIndicator
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from ..shared.figures import pixels

Region = tuple[tuple[float, float], tuple[float, float]]
"""Limits in x and y of a part of the axes."""
Box = tuple[float, float, float, float] | np.ndarray
"""Left, lower, right and upper edge on the page, in pixels."""

CELL = 2.0  # pixels: width of the cells of the raster
TAKEN = 1e3  # weight of cells of texts, legends and insets; cells of curves and marks have weight 1
# points: distances of a text from its anchor that are tried
RADII = np.array([7.0, 11.0, 16.0, 24.0, 34.0, 46.0, 62.0])
LEADER = 14.0  # points: from this distance on, a thin line joins text and anchor
ANGLES = np.pi * (0.25 + np.arange(16) / 8)  # directions from an anchor to its text
PLACES = np.array([(r, np.cos(a), np.sin(a)) for r in RADII for a in ANGLES])
WORST = {False: 60.0, True: 24.0}  # largest cost of a label of a point (False), of a branch (True)
GAP = 3.0  # points: horizontal distance of neighbouring texts
# a text is ambiguous if another mark is nearer than this multiple of the distance from its own mark
AS_NEAR = 1.25
NEAR = 9.0  # points: marks nearer than this share a label
CROWD = 9  # largest number of names left out of a shared label; beyond it, the label is the number of points


@dataclass(frozen=True)
class Label:
    """A text and its anchor (x, y) in data coordinates."""

    text: str
    x: float
    y: float
    color: str = "black"
    rank: int = 0  # labels of smaller rank are placed first, and come first in shared labels
    kept: bool = False  # written even if it covers something
    near: bool = False  # only places near the anchor: labels of branches


class Raster:
    """Raster of the area of axes, with a weight for each cell that is covered by a curve, mark, text, legend or inset."""

    def __init__(self, axes: Axes, legend: bool = True) -> None:
        self.origin = np.asarray(axes.bbox.min)
        self.weights = np.zeros((np.asarray(axes.bbox.size) / CELL).astype(int) + 2)
        for line in axes.lines:
            if line.get_transform().contains_branch(axes.transData):
                self.add(covered_points(line))
        for artist in axes.artists:
            if isinstance(artist, InsetIndicator):
                self.add(along(artist.rectangle.get_window_extent().corners()[[0, 1, 3, 2, 0]]))
                for line in artist.connectors or ():
                    if line.get_visible():
                        self.add(along(line.get_transform().transform(line.get_path().vertices)))
        for thing in (*axes.texts, *axes.child_axes, axes.get_legend() if legend else None):
            box = None if thing is None else thing.get_tightbbox()
            if box is not None:
                self.add_box(box.extents)

    def add(self, points: np.ndarray, weight: float = 1.0) -> None:
        """Give a weight to the cells that contain points of the page, shape (n, 2)."""
        cells = np.floor((points[np.isfinite(points).all(axis=1)] - self.origin) / CELL).astype(int)
        cells = cells[((cells >= 0) & (cells < self.weights.shape)).all(axis=1)]
        self.weights[tuple(cells.T)] = np.maximum(self.weights[tuple(cells.T)], weight)

    def add_box(self, box: Box) -> None:
        """Give the weight `TAKEN` to the cells of a box."""
        x0, y0, x1, y1 = self._cells(box)[:, 0]
        self.weights[x0:x1, y0:y1] = TAKEN

    def covered(self, boxes: Box) -> np.ndarray:
        """Return the sum of the weights under each box, shape (n,); `boxes` has the shape (n, 4) or (4,)."""
        s = np.pad(self.weights.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        x0, y0, x1, y1 = self._cells(boxes)
        return s[x1, y1] - s[x0, y1] - s[x1, y0] + s[x0, y0]

    def crossed(self, lines: np.ndarray) -> np.ndarray:
        """Return the sum of the weights along straight lines (n, 2 ends, 2), without the curve on which the first end lies, shape (n,)."""
        count = int(np.abs(np.diff(lines, axis=1)).max() / CELL) + 2
        places = lines[:, :1] + np.linspace(0.0, 1.0, count)[:, None] * (lines[:, 1:] - lines[:, :1])
        cells = np.floor((places - self.origin) / CELL).astype(int)
        met = self.weights[tuple(np.clip(cells, 0, np.array(self.weights.shape) - 1).T)].T
        return np.sum(met * ((np.cumsum(met == 0.0, axis=1) > 2) | (met >= TAKEN)), axis=1)

    def free(self, size: np.ndarray, inside: np.ndarray | None = None) -> np.ndarray:
        """Return the lower left corners of the free boxes of a size in pixels, shape (n, 2), the lowest first.

        With `inside`, a bool per cell, boxes must lie in these cells and may cover curves.
        """
        taken = self.weights > 0.0 if inside is None else (self.weights >= TAKEN) | ~inside
        s = np.pad(taken.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        w, h = np.ceil(np.asarray(size) / CELL).astype(int)
        total = s[w:, h:] - s[:-w, h:] - s[w:, :-h] + s[:-w, :-h]
        return self.origin + CELL * np.argwhere(total.T == 0)[:, ::-1]

    def _cells(self, boxes: Box) -> np.ndarray:
        """Return the first and last (exclusive) cells of boxes, shape (4, n)."""
        corners = (np.atleast_2d(boxes) - np.tile(self.origin, 2)) / CELL + [0.0, 0.0, 1.0, 1.0]
        return np.clip(corners, 0, np.tile(self.weights.shape, 2)).astype(int).T


def along(page: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """Return points along a line on the page that are nearer to one another than the cells of the raster."""
    page = np.asarray(page, dtype=float)
    steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T))
    total = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, total[-1], int(np.clip(total[-1] / 1.5, 2, 20000)))
    return np.column_stack([np.interp(at, total, v) for v in page.T])


def is_curve(line: Line2D) -> bool:
    """Whether a line joins its points, instead of marks only."""
    return np.size(line.get_xdata()) > 1 and line.get_linestyle() not in ("None", "none", "")


def covered_points(line: Line2D) -> np.ndarray:
    """Return points of the page that are covered by a curve, or by the marks of a line without one, shape (n, 2)."""
    page = line.get_transform().transform(np.asarray(line.get_xydata(), dtype=float))
    if is_curve(line):
        return along(page)
    half = 0.6 * line.get_markersize() * line.get_figure(root=True).dpi / 72.0  # type: ignore[union-attr]
    across = np.linspace(-half, half, int(2.0 * half / CELL) + 2)
    return (page[:, None] + np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)).reshape(-1, 2)


def place_labels(axes: Axes, labels: Sequence[Label], size: float) -> list[Annotation]:
    """Write labels: each at the place with the lowest cost, among 16 directions and the distances `RADII` from its anchor.

    Limits and size of the axes must be final. `size` is the font size in points. Labels outside the axes are ignored.
    """
    unit, raster = pixels(axes), Raster(axes)
    low, high = np.asarray(axes.bbox.get_points())
    anchors = axes.transData.transform(np.array([[label.x, label.y] for label in labels]).reshape(-1, 2))
    written = []
    for i in sorted(range(len(labels)), key=lambda i: (not labels[i].kept, labels[i].near, labels[i].rank)):
        label, at = labels[i], anchors[i]
        if not axes.bbox.padded(1.0).contains(*at):
            continue
        text = axes.text(0.0, 0.0, label.text, fontsize=size)
        extent = np.asarray(text.get_window_extent().size) + [2.0 * unit, 0.0]
        text.remove()
        places = PLACES[PLACES[:, 0] < LEADER] if label.near else PLACES
        radii, ways = places[:, 0], places[:, 1:]
        middles = at + radii[:, None] * unit * ways + 0.5 * extent * np.sign(np.round(ways, 6))
        boxes = np.hstack([middles - 0.5 * extent, middles + 0.5 * extent])
        leads = raster.crossed(np.stack([np.broadcast_to(at, middles.shape), middles], axis=1))
        outside = np.any((boxes[:, :2] < low) | (boxes[:, 2:] > high), axis=1)
        cost = 0.3 * radii + _claimed(boxes, i, anchors) + 6.0 * raster.covered(boxes)
        cost += np.where(radii >= LEADER, 4.0 * leads, 0.0) + TAKEN * outside
        k = int(np.argmin(cost))
        if cost[k] > WORST[label.near] and not label.kept:
            continue
        leader = {"arrowstyle": "-", "color": "0.55", "lw": 0.6, "shrinkA": 1, "shrinkB": 3}
        look = {"ha": "center", "va": "center", "fontsize": size, "color": label.color, "zorder": 8}
        look["bbox"] = {"boxstyle": "square,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.75}
        look["arrowprops"] = leader if radii[k] >= LEADER else None
        offset = tuple((middles[k] - at) / unit)
        written.append(
            axes.annotate(label.text, (label.x, label.y), offset, textcoords="offset points", **look)
        )
        raster.add_box(boxes[k] + GAP * unit * np.array([-1, 0, 1, 0]))
        if radii[k] >= LEADER:
            line = along([at, middles[k]])
            raster.add(np.concatenate([line, line + [CELL, 0.0]]), TAKEN)  # two cells wide
    return written


def _claimed(boxes: np.ndarray, own: int, anchors: np.ndarray) -> np.ndarray:
    """Return the cost of boxes that are nearer to another anchor than to their own (of index `own`), or about as near, shape (n,)."""
    apart = np.maximum(np.maximum(boxes[:, None, :2] - anchors, anchors - boxes[:, None, 2:]), 0.0)
    gaps = np.hypot(apart[..., 0], apart[..., 1])
    ours, nearest = gaps[:, own], np.delete(gaps, own, axis=1).min(axis=1, initial=np.inf)
    return np.where(nearest < ours - 1.0, 30.0, np.where(nearest < AS_NEAR * ours, 10.0, 0.0))


def grouped(axes: Axes, labels: Sequence[Label], named: int = 3) -> list[Label]:
    """Join labels within `NEAR` points of one another: "PD1, PD2", "PD1, PD2 +3" above `named` names, "20 points" for a crowd."""
    groups: list[tuple[np.ndarray, list[Label]]] = []
    for label in labels:
        spot = axes.transData.transform((label.x, label.y)) / pixels(axes)
        beside = next((group for at, group in groups if np.hypot(*(at - spot)) < NEAR), None)
        groups.append((spot, [label])) if beside is None else beside.append(label)
    found = []
    for _, group in groups:
        group.sort(key=lambda label: label.rank)
        names = list(dict.fromkeys(label.text for label in group))
        shown = names if len(names) <= named else names[: named - 1]
        more = len(names) - len(shown)
        text = f"{len(names)} points" if more > CROWD else ", ".join(shown) + (f" +{more}" if more else "")
        found.append(replace(group[0], text=text))
    return found


# ------------------------------------------------------------------ insets
CROWDED = 6  # smallest number of marks that hide one another in an inset's region
CROWDED_SHARE = 0.35  # their smallest part of all marks: a picture that is crowded everywhere has no inset
HIDING = 11.0  # points: marks nearer than this hide one another
WIDEST = 0.3  # relative to the axes: largest extent of the marks
LEAST_INSET = (1.35, 0.95)  # inches: smallest inset, tick labels included
# sizes of the inset that are tried, relative to the axes
SIZES = np.array([(w, h) for w in range(56, 23, -4) for h in range(56, 23, -4)]) / 100.0
MOST_ZOOM = 400.0  # largest magnification of an inset


def crowded_region(axes: Axes, spots: np.ndarray) -> Region | None:
    """Return the limits of the region where most marks hide one another, or None; `spots`: marks in data coordinates, shape (n, 2)."""
    if len(spots) < CROWDED:
        return None
    page = axes.transData.transform(spots)
    near = np.hypot(*(page[:, None] - page[None]).T) < HIDING * pixels(axes)
    for _ in range(int(np.ceil(np.log2(len(spots)))) + 1):  # chains of neighbours are one crowd
        near = near @ near
    crowd = page[near[np.argmax(near.sum(axis=1))]]
    size, frame = np.ptp(crowd, axis=0), np.asarray(axes.bbox.size)
    if len(crowd) < max(CROWDED, CROWDED_SHARE * len(spots)) or np.any(size > WIDEST * frame):
        return None
    if np.all(size < 0.02 * pixels(axes)):
        return None  # all at one point, which no magnification separates
    half = np.maximum(0.725 * size, 0.5 * frame / MOST_ZOOM)
    middle = 0.5 * (crowd.min(axis=0) + crowd.max(axis=0))
    (x0, y0), (x1, y1) = axes.transData.inverted().transform([middle - half, middle + half]).tolist()
    return (x0, x1), (y0, y1)


def add_inset(axes: Axes, region: Region, size: float) -> tuple[Axes, InsetIndicator] | None:
    """Return empty inset axes with the limits of a region, in the largest free rectangle, and its indicator; None if there is no room.

    `size` is the font size of the tick labels in points.
    """
    raster, frame, unit = Raster(axes), np.asarray(axes.bbox.size), pixels(axes)
    corners = axes.transData.transform(np.transpose(region))
    raster.add_box(np.concatenate([corners.min(axis=0), corners.max(axis=0)]))
    edge = 0.012 * axes.bbox.width
    for extent in SIZES[np.argsort(-SIZES.prod(axis=1), kind="stable")] * frame:
        places = raster.free(extent + edge)
        if len(places) and np.all(extent >= np.array(LEAST_INSET) * 72.0 * unit):
            break
    else:
        return None
    ticks = np.array([4.2, 1.9]) * size * unit  # room for their labels at the left and below
    x, y = (places[0] + 0.5 * edge + ticks - axes.bbox.min) / frame
    width, height = (extent - ticks) / frame
    inset = axes.inset_axes((x, y, width, height), zorder=7)
    inset.set(xlim=region[0], ylim=region[1])
    inset.tick_params(labelsize=size, length=2.5, pad=1.5)
    for axis, count in ((inset.xaxis, 3), (inset.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(ScalarFormatter(useOffset=False))
    inset.spines[:].set(visible=True, color="0.45", linewidth=0.7)
    return inset, axes.indicate_inset_zoom(inset, edgecolor="0.45", linewidth=0.7, alpha=1.0, zorder=1.6)
