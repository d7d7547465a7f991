"""Labels and insets: what finds room between curves and marks; a label without a clean place is left out and counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .figures import pixels
from .settings import DRAWING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.inset import InsetIndicator
    from matplotlib.text import Annotation
    from matplotlib.transforms import Bbox


Box = tuple[float, float, float, float] | np.ndarray
"""Left, low, right and high ends on the page."""

RADII = (7, 11, 16, 24, 34, 46, 62)  # points on the page between an anchor and its text
LEADER = 14  # from this radius on a thin line leads from the text to its anchor
ANGLES = np.pi * (0.25 + np.arange(16) / 8)
WAYS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])  # from an anchor to its text
CELL = 2.0  # pixels of the raster in which curves are drawn for the search
WORST = (60.0, 24.0)  # cost above which a label is left out: of a point, and of a branch's name
ALONG = 16.0  # half cells of a leader on a curve that count as much as crossing it
GAP = 3.0  # points between neighbouring texts
EDGE = 1.5  # points between a text and the frame
AS_NEAR = 1.25  # times its distance from its own mark: a text that near to another one could be either's
PLACES = np.linspace(0.0, 1.0, 24)[:, None]  # along a leader, where it may pass through a box
NEAR = 9.0  # points on the page between points that share a label
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
    axes: Axes, labels: Sequence[Label], obstacles: np.ndarray, *, size: float, taken: Sequence[Box] = ()
) -> list[Annotation]:
    """Write each label where it covers nothing: the cheapest of 16 places on each of a few circles about its anchor.

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
    """
    unit = pixels(axes)
    low, high = np.asarray(axes.bbox.get_points())
    anchors = axes.transData.transform(np.array([[entry.x, entry.y] for entry in labels]).reshape(-1, 2))
    ground = Ground(axes.bbox, axes.transData.transform(obstacles))
    widths = text_widths({label.text for label in labels}, size)
    marks = np.hstack([anchors - 4 * unit, anchors + 4 * unit])
    boxes, leaders, written = np.array(taken).reshape(-1, 4), np.empty((0, 4)), []
    for i in sorted(range(len(labels)), key=lambda i: (not labels[i].kept, labels[i].near, labels[i].rank)):
        label, at = labels[i], anchors[i]
        if not (np.all(low - 1 <= at) and np.all(at <= high + 1)):
            continue
        extent = np.array([widths[label.text] + 2, 1.2 * size]) * unit
        others = np.delete(marks, i, axis=0)
        best = (np.inf, at, np.empty(4), np.empty(4), 0)
        for radius in RADII[:2] if label.near else RADII:
            middles = at + radius * unit * WAYS + 0.5 * extent * np.sign(np.round(WAYS, 6))
            new = np.hstack([middles - 0.5 * extent, middles + 0.5 * extent])
            lines = np.hstack([np.tile(at, (len(middles), 1)), middles])
            out = np.maximum(low - new[:, :2], new[:, 2:] - high).max(axis=1) / unit + EDGE
            blocked = (out > EDGE) | touching(new, boxes).any(axis=1) | _crossing(leaders, new).any(axis=0)
            cost = 0.3 * radius + _claimed(new, i, anchors) + 10 * np.maximum(out, 0.0)
            cost += 6 * np.minimum(ground.covered(new), 40) + 25 * touching(new, others).sum(axis=1)
            if radius >= LEADER:
                blocked |= _crossing(lines, boxes).any(axis=1) | _meeting(lines, leaders).any(axis=1)
                cost += 8 * _crossing(lines, others).sum(axis=1) + 12 * ground.crossed(lines)
            cost = np.where(blocked, DRAWING.blocked, cost)
            k = int(np.argmin(cost))
            if cost[k] < best[0]:
                best = (float(cost[k]), middles[k], new[k], lines[k], radius)
            if best[0] < RADII[0]:
                break
        cost, middle, box, line, radius = best
        if cost > WORST[label.near] and not label.kept:
            continue
        boxes = np.vstack([boxes, box + GAP * unit * np.array([-1, 0, 1, 0])])
        leader = None
        if radius >= LEADER:
            leaders = np.vstack([leaders, line])
            leader = {"arrowstyle": "-", "color": "0.55", "lw": 0.6, "shrinkA": 1, "shrinkB": 3}
        text = axes.annotate(
            label.text,
            (label.x, label.y),
            tuple((middle - at) / unit),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            color=label.color,
            arrowprops=leader,
            bbox={"boxstyle": "square,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.75},
            zorder=8,
        )
        written.append(text)
    return written


def grouped(axes: Axes, labels: Sequence[Label], named: int = 3) -> list[Label]:
    """One label for those that lie within `NEAR` points of one another on the page.

    Above `named` names, "+n" stands for n more; where very many lie together, their number stands for all.
    """
    spots = axes.transData.transform(np.array([[entry.x, entry.y] for entry in labels]).reshape(-1, 2))
    groups: list[list[int]] = []
    for i, point in enumerate(spots / pixels(axes)):
        beside = (g for g in groups if np.hypot(*(spots[g[0]] / pixels(axes) - point)) < NEAR)
        group = None if labels[i].kept else next(beside, None)
        groups.append([i]) if group is None else group.append(i)
    found = []
    for group in groups:
        ranked = sorted((labels[i] for i in group), key=lambda label: label.rank)
        names = list(dict.fromkeys(label.text for label in ranked))
        shown = names if len(names) <= named else names[: named - 1]
        more = len(names) - len(shown)
        text = f"{len(names)} points" if more > CROWD else ", ".join(shown) + (f" +{more}" if more else "")
        found.append(replace(ranked[0], text=text))
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
    """How much of the axes curves cover: sums over a raster of cells."""

    def __init__(self, frame: Bbox, points: np.ndarray) -> None:
        self.origin = np.array([frame.x0, frame.y0])
        self.shape = int(frame.width / CELL) + 2, int(frame.height / CELL) + 2
        cells = ((points[np.isfinite(points).all(axis=1)] - self.origin) / CELL).astype(int)
        self.raster = np.zeros(self.shape)
        self.raster[tuple(cells[((cells >= 0) & (cells < self.shape)).all(axis=1)].T)] = 1.0
        self.sums = np.pad(self.raster.cumsum(0).cumsum(1), ((1, 0), (1, 0)))

    def covered(self, boxes: np.ndarray) -> np.ndarray:
        """Cells with a curve in each of the boxes (n, 4), shape (n,)."""
        corners = np.tile(self.origin, 2) - [0.0, 0.0, CELL, CELL]
        x0, y0, x1, y1 = np.clip((boxes - corners) / CELL, 0, np.tile(self.shape, 2)).astype(int).T
        s = self.sums
        return s[x1, y1] - s[x0, y1] - s[x1, y0] + s[x0, y0]

    def crossed(self, lines: np.ndarray) -> np.ndarray:
        """How many curves straight lines (n, 4) cross, but for those at their first ends; more where they run along one."""
        count = max(int(np.hypot(*(lines[:, 2:] - lines[:, :2]).T).max() / CELL), 1)
        along = np.linspace(0.0, 1.0, 2 * count)[:, None]
        places = lines[:, None, :2] + along * (lines[:, 2:] - lines[:, :2])[:, None]
        cells = np.clip((places - self.origin) / CELL, 0, np.array(self.shape) - 1).astype(int)
        met = self.raster[cells[..., 0], cells[..., 1]] > 0.0
        away = met & (np.cumsum(~met, axis=1) > 2)  # the anchor lies on a curve of its own
        return np.sum(away[:, 1:] & ~away[:, :-1], axis=1) + np.sum(away, axis=1) / ALONG


def _claimed(boxes: np.ndarray, own: int, anchors: np.ndarray) -> np.ndarray:
    """What it costs that texts stand nearer to something else than to what they name (by its index), or about as near."""
    if len(anchors) < 2:
        return np.zeros(len(boxes))
    apart = np.maximum(np.maximum(boxes[:, None, :2] - anchors, anchors - boxes[:, None, 2:]), 0.0)
    gaps = np.hypot(apart[..., 0], apart[..., 1])
    ours, nearest = gaps[:, own], np.delete(gaps, own, axis=1).min(axis=1)
    return np.where(nearest < ours - 1.0, 30.0, np.where(nearest < AS_NEAR * ours, 10.0, 0.0))


def touching(some: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which boxes (n, 4) share something with which others (m, 4), shape (n, m)."""
    one, two = some[:, None], others[None]
    return np.all((one[..., :2] < two[..., 2:]) & (two[..., :2] < one[..., 2:]), axis=-1)


def _crossing(lines: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """Which lines (n, 4) from (x0, y0) to (x1, y1) pass through which boxes (m, 4), shape (n, m)."""
    at = (lines[:, None, :2] + PLACES * (lines[:, 2:] - lines[:, :2])[:, None])[:, :, None]
    return np.any(np.all((at > boxes[:, :2]) & (at < boxes[:, 2:]), axis=-1), axis=1)


def _meeting(some: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which line segments (n, 4) cross which others (m, 4), shape (n, m)."""

    def apart(ends: np.ndarray, lines: np.ndarray) -> np.ndarray:
        """Whether the ends of segments lie on unlike sides of lines."""
        (dx, dy) = (lines[..., 2:] - lines[..., :2]).T
        x, y = (ends.reshape(*ends.shape[:-1], 2, 2) - lines[..., None, :2]).T
        return np.prod(dx * y - dy * x, axis=0).T < 0.0

    one, two = np.broadcast_arrays(some[:, None], others[None])
    return apart(one, two) & apart(two, one)


CROWDED = 6  # marks that hide one another ask for an inset,
CROWDED_SHARE = (
    0.35  # if they are this part of all marks: a picture crowded everywhere needs its room for labels
)
HIDING = 11.0  # points on the page: nearer marks hide one another
WIDEST = 0.3  # of the axes: a wider crowd is no single place
LEAST_INSET = (1.35, 0.95)  # inches: a smaller inset shows nothing
SIZES = np.array([0.56, 0.5, 0.44, 0.38, 0.33, 0.28, 0.24])  # of the axes
STEPS = 40  # places tried along either side
MOST_ZOOM = 400.0

Region = tuple[tuple[float, float], tuple[float, float]]


def crowded_region(axes: Axes, spots: np.ndarray) -> Region | None:
    """Limits of the place where most marks hide one another; None where no place is crowded.

    Parameters
    ----------
    axes : its limits must be final.
    spots : float array (n, 2), data coordinates of the marks that can be seen.
    """
    if len(spots) < CROWDED:
        return None
    page = axes.transData.transform(spots)
    near = (np.hypot(*(page[:, None] - page[None]).T) < HIDING * pixels(axes)).astype(float)
    for _ in range(int(np.ceil(np.log2(len(spots)))) + 1):  # chains of neighbours belong together
        near = (near @ near > 0).astype(float)
    crowd = page[near[int(np.argmax(near.sum(axis=1)))] > 0]
    if len(crowd) < max(CROWDED, CROWDED_SHARE * len(spots)):
        return None
    low, high, frame = crowd.min(axis=0), crowd.max(axis=0), np.ptp(axes.bbox.get_points(), axis=0)
    if np.any(high - low > WIDEST * frame) or np.all(high - low < 0.02 * pixels(axes)):
        return None  # too wide, or all at one point, which no zoom takes apart
    half = np.maximum(0.5 * (high - low) * 1.45, 0.5 * frame / MOST_ZOOM)
    middle = 0.5 * (low + high)
    (x0, y0), (x1, y1) = axes.transData.inverted().transform([middle - half, middle + half]).tolist()
    return (x0, x1), (y0, y1)


def find_room(axes: Axes, region: Region, obstacles: np.ndarray, taken: Sequence[Box]) -> Box | None:
    """The largest free rectangle of the axes, in axes coordinates (x, y, width, height); None where all are small.

    Parameters
    ----------
    axes : its limits must be final.
    region : what the inset will show; it stays free.
    obstacles : float array (n, 2), data coordinates of points close together on the curves.
    taken : boxes on the page that stay free, such as the legend's.
    """
    (first, last), ground = axes.bbox.get_points(), Ground(axes.bbox, axes.transData.transform(obstacles))
    corners = axes.transData.transform(np.array(region).T)
    boxes = np.array([*taken, (*corners.min(axis=0), *corners.max(axis=0))])
    sizes = np.stack(np.meshgrid(SIZES, SIZES, indexing="ij"), axis=-1).reshape(-1, 2)
    edge = 0.012 * axes.bbox.width
    for size in sizes[np.argsort(-sizes.prod(axis=1), kind="stable")]:
        extent = size * (last - first)
        if np.any(extent < np.array(LEAST_INSET) * 72.0 * pixels(axes)):
            continue
        xs, ys = np.linspace(first + edge, last - edge - extent, STEPS).T
        low = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)  # from the lower left on
        places = np.hstack([low, low + extent])
        free = (ground.covered(places) == 0.0) & ~touching(places, boxes).any(axis=1)
        if free.any():
            x, y = ((low[np.argmax(free)] - first) / (last - first)).tolist()
            return x, y, float(size[0]), float(size[1])
    return None


def add_inset(axes: Axes, region: Region, room: Box, size: float) -> tuple[Axes, InsetIndicator]:
    """Empty axes with the limits of a region in a free rectangle; a frame and two lines say what they show.

    Parameters
    ----------
    axes : Axes
    region : limits of the inset.
    room : x, y, width, height in axes coordinates, tick labels included.
    size : of the tick labels, in points.
    """
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    left, low = np.array([4.2, 1.9]) * size * pixels(axes) / axes.bbox.size
    x, y, width, height = room
    inset = axes.inset_axes((x + left, y + low, width - left, height - low), zorder=7)
    inset.set(xlim=region[0], ylim=region[1])
    inset.tick_params(labelsize=size, length=2.5, pad=1.5)
    for axis, count in ((inset.xaxis, 3), (inset.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(ScalarFormatter(useOffset=False))
    inset.spines[:].set(visible=True, color="0.45", linewidth=0.7)
    return inset, axes.indicate_inset_zoom(inset, edgecolor="0.45", linewidth=0.7, alpha=1.0, zorder=1.6)


def outlines(axes: Axes, inset: Axes, shown: InsetIndicator) -> list[np.ndarray]:
    """The lines of :func:`add_inset` in data coordinates of the axes, shape (n, 2) each: no label may stand on them."""
    back = axes.transData.inverted()
    found = [back.transform(shown.rectangle.get_window_extent().corners()[[0, 1, 3, 2, 0]])]
    for line in shown.connectors or ():
        if line.get_visible():
            found.append(np.array([back.transform(inset.transAxes.transform(line.xy1)), line.xy2]))
    return found
