"""Labels and insets: what finds room between curves and marks; a label without a clean place is left out."""

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
"""Limits of a part of the axes."""
Box = tuple[float, float, float, float] | np.ndarray
"""Left, low, right and high ends on the page."""

CELL = 2.0  # pixels of the raster on which room is sought
TAKEN = 1e3  # weight of a cell that nothing may touch, beside those of curves and marks, 1 each
RADII = np.array([7.0, 11.0, 16.0, 24.0, 34.0, 46.0, 62.0])  # points between an anchor and its text
LEADER = 14.0  # from this radius on a thin line leads from the text to its anchor
ANGLES = np.pi * (0.25 + np.arange(16) / 8)  # of the way from an anchor to its text
PLACES = np.array([(r, np.cos(a), np.sin(a)) for r in RADII for a in ANGLES])
WORST = {False: 60.0, True: 24.0}  # cost above which a label is left out: of a point, and of a branch's name
GAP = 3.0  # points between neighbouring texts
AS_NEAR = 1.25  # times its distance from its own mark: a text that near to another one could be either's
NEAR = 9.0  # points on the page between points that share a label
CROWD = 9  # with more than so many further names at one place none of them says anything


@dataclass(frozen=True)
class Label:
    """A text that belongs to a place, x and y in data coordinates."""

    text: str
    x: float
    y: float
    color: str = "black"
    rank: int = 0  # smaller ones are placed first; from labels at one place the first few are named
    kept: bool = False  # placed whatever it covers; else left out where no clean place is found
    near: bool = False  # left out rather than put far from its place: names of branches


class Ground:
    """What is taken of some axes, as weights on a raster of the page: curves, marks, texts, the legend, insets."""

    def __init__(self, axes: Axes, legend: bool = True) -> None:
        self.origin = np.asarray(axes.bbox.min)
        self.raster = np.zeros((np.asarray(axes.bbox.size) / CELL).astype(int) + 2)
        for line in axes.lines:
            if line.get_transform().contains_branch(axes.transData):
                self.add(on_page(line))
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
        """Take the cells in which these points of the page, shape (n, 2), lie."""
        cells = np.floor((points[np.isfinite(points).all(axis=1)] - self.origin) / CELL).astype(int)
        cells = cells[((cells >= 0) & (cells < self.raster.shape)).all(axis=1)]
        self.raster[tuple(cells.T)] = np.maximum(self.raster[tuple(cells.T)], weight)

    def add_box(self, box: Box) -> None:
        """Take a box of the page (left, low, right, high), which nothing may touch."""
        x0, y0, x1, y1 = self._cells(box)[:, 0]
        self.raster[x0:x1, y0:y1] = TAKEN

    def covered(self, boxes: Box) -> np.ndarray:
        """Sums of the weights under boxes (n, 4), or one of them, shape (n,)."""
        s = np.pad(self.raster.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        x0, y0, x1, y1 = self._cells(boxes)
        return s[x1, y1] - s[x0, y1] - s[x1, y0] + s[x0, y0]

    def crossed(self, lines: np.ndarray) -> np.ndarray:
        """Sums of the weights along straight lines (n, 2 ends, 2), but for the curves on which their first ends lie, shape (n,)."""
        count = int(np.abs(np.diff(lines, axis=1)).max() / CELL) + 2
        places = lines[:, :1] + np.linspace(0.0, 1.0, count)[:, None] * (lines[:, 1:] - lines[:, :1])
        cells = np.floor((places - self.origin) / CELL).astype(int)
        met = self.raster[tuple(np.clip(cells, 0, np.array(self.raster.shape) - 1).T)].T
        return np.sum(met * ((np.cumsum(met == 0.0, axis=1) > 2) | (met >= TAKEN)), axis=1)

    def free(self, size: np.ndarray, inside: np.ndarray | None = None) -> np.ndarray:
        """Lower left corners of the free boxes of a size on the page, shape (n, 2), the lowest first.

        With `inside`, a bool for each cell, they must lie there, and curves may pass.
        """
        taken = self.raster > 0.0 if inside is None else (self.raster >= TAKEN) | ~inside
        s = np.pad(taken.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        w, h = np.ceil(np.asarray(size) / CELL).astype(int)
        total = s[w:, h:] - s[:-w, h:] - s[w:, :-h] + s[:-w, :-h]
        return self.origin + CELL * np.argwhere(total.T == 0)[:, ::-1]

    def _cells(self, boxes: Box) -> np.ndarray:
        """First and last cells of boxes (n, 4), the last ones exclusive, shape (4, n)."""
        corners = (np.atleast_2d(boxes) - np.tile(self.origin, 2)) / CELL + [0.0, 0.0, 1.0, 1.0]
        return np.clip(corners, 0, np.tile(self.raster.shape, 2)).astype(int).T


def along(page: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """Points close together along a line on the page, so that nothing slips between two of them."""
    page = np.asarray(page, dtype=float)
    steps = np.nan_to_num(np.hypot(*np.diff(page, axis=0).T))
    total = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, total[-1], int(np.clip(total[-1] / 1.5, 2, 20000)))
    return np.column_stack([np.interp(at, total, v) for v in page.T])


def is_curve(line: Line2D) -> bool:
    """Whether a line joins its points."""
    return np.size(line.get_xdata()) > 1 and line.get_linestyle() not in ("None", "none", "")


def on_page(line: Line2D) -> np.ndarray:
    """What a curve, or the marks of a line without one, take of the page, shape (n, 2)."""
    page = line.get_transform().transform(np.asarray(line.get_xydata(), dtype=float))
    if is_curve(line):
        return along(page)
    half = 0.6 * line.get_markersize() * line.get_figure(root=True).dpi / 72.0  # type: ignore[union-attr]
    across = np.linspace(-half, half, int(2.0 * half / CELL) + 2)
    return (page[:, None] + np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)).reshape(-1, 2)


def place_labels(axes: Axes, labels: Sequence[Label], size: float) -> list[Annotation]:
    """Write each label where it covers nothing: the cheapest of 16 places on each of a few circles about its anchor.

    The limits of the axes must be final; `size` is that of the font, in points. Labels of places outside are ignored.
    """
    unit, ground = pixels(axes), Ground(axes)
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
        leads = ground.crossed(np.stack([np.broadcast_to(at, middles.shape), middles], axis=1))
        outside = np.any((boxes[:, :2] < low) | (boxes[:, 2:] > high), axis=1)
        cost = 0.3 * radii + _claimed(boxes, i, anchors) + 6.0 * ground.covered(boxes)
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
        ground.add_box(boxes[k] + GAP * unit * np.array([-1, 0, 1, 0]))
        if radii[k] >= LEADER:
            line = along([at, middles[k]])
            ground.add(np.concatenate([line, line + [CELL, 0.0]]), TAKEN)  # so wide that none slips across
    return written


def _claimed(boxes: np.ndarray, own: int, anchors: np.ndarray) -> np.ndarray:
    """What it costs that texts stand nearer to something else than to what they name (by its index), or about as near."""
    apart = np.maximum(np.maximum(boxes[:, None, :2] - anchors, anchors - boxes[:, None, 2:]), 0.0)
    gaps = np.hypot(apart[..., 0], apart[..., 1])
    ours, nearest = gaps[:, own], np.delete(gaps, own, axis=1).min(axis=1, initial=np.inf)
    return np.where(nearest < ours - 1.0, 30.0, np.where(nearest < AS_NEAR * ours, 10.0, 0.0))


def grouped(axes: Axes, labels: Sequence[Label], named: int = 3) -> list[Label]:
    """One label for those that lie within `NEAR` points of one another on the page.

    Above `named` names, "+n" stands for n more; where very many lie together, their number stands for all.
    """
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
CROWDED = 6  # marks that hide one another ask for an inset,
CROWDED_SHARE = 0.35  # if they are this part of all: a picture crowded everywhere needs its room for labels
HIDING = 11.0  # points on the page: nearer marks hide one another
WIDEST = 0.3  # of the axes: a wider crowd is no single place
LEAST_INSET = (1.35, 0.95)  # inches: a smaller inset shows nothing
SIZES = np.array([(w, h) for w in range(56, 23, -4) for h in range(56, 23, -4)]) / 100.0  # of the axes
MOST_ZOOM = 400.0


def crowded_region(axes: Axes, spots: np.ndarray) -> Region | None:
    """Limits of the place where most marks, `spots` (n, 2) in data coordinates, hide one another; None where no place is crowded."""
    if len(spots) < CROWDED:
        return None
    page = axes.transData.transform(spots)
    near = np.hypot(*(page[:, None] - page[None]).T) < HIDING * pixels(axes)
    for _ in range(int(np.ceil(np.log2(len(spots)))) + 1):  # chains of neighbours belong together
        near = near @ near
    crowd = page[near[np.argmax(near.sum(axis=1))]]
    size, frame = np.ptp(crowd, axis=0), np.asarray(axes.bbox.size)
    if len(crowd) < max(CROWDED, CROWDED_SHARE * len(spots)) or np.any(size > WIDEST * frame):
        return None
    if np.all(size < 0.02 * pixels(axes)):
        return None  # all at one point, which no zoom takes apart
    half = np.maximum(0.725 * size, 0.5 * frame / MOST_ZOOM)
    middle = 0.5 * (crowd.min(axis=0) + crowd.max(axis=0))
    (x0, y0), (x1, y1) = axes.transData.inverted().transform([middle - half, middle + half]).tolist()
    return (x0, x1), (y0, y1)


def add_inset(axes: Axes, region: Region, size: float) -> tuple[Axes, InsetIndicator] | None:
    """Empty axes with the limits of a region in the largest free rectangle; a frame and two lines say what they show.

    The tick labels have this size, in points. None where there is no room.
    """
    ground, frame, unit = Ground(axes), np.asarray(axes.bbox.size), pixels(axes)
    corners = axes.transData.transform(np.transpose(region))
    ground.add_box(np.concatenate([corners.min(axis=0), corners.max(axis=0)]))
    edge = 0.012 * axes.bbox.width
    for extent in SIZES[np.argsort(-SIZES.prod(axis=1), kind="stable")] * frame:
        places = ground.free(extent + edge)
        if len(places) and np.all(extent >= np.array(LEAST_INSET) * 72.0 * unit):
            break
    else:
        return None
    ticks = np.array([4.2, 1.9]) * size * unit  # their labels stand at the left and below
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
