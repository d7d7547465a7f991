"""An inset for the most crowded place of a diagram, where the picture has room for one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .labels import Box, Ground

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox


MANY = 6  # marks that hide one another ask for an inset,
MOST = (
    0.35  # if they are this part of all marks: a picture that is crowded everywhere needs its room for labels
)
NEAR = 11.0  # points on the page: nearer marks hide one another
SMALL = 0.3  # of the axes: a wider crowd is no single place
LEAST = (1.35, 0.95)  # inches: a smaller inset shows nothing
SIZES = (0.56, 0.5, 0.44, 0.38, 0.33, 0.28, 0.24)  # of the axes, tried from large to small
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
    if len(spots) < MANY:
        return None
    figure = axes.get_figure(root=True)
    assert figure is not None
    page = axes.transData.transform(spots)
    apart = np.hypot(*(page[:, None] - page[None]).transpose(2, 0, 1)) * 72.0 / figure.dpi
    near = (apart < NEAR).astype(float)
    for _ in range(int(np.ceil(np.log2(len(spots)))) + 1):  # chains of neighbours belong together
        near = (near @ near > 0).astype(float)
    size = near.sum(axis=1)
    crowd = page[near[int(np.argmax(size))] > 0]
    if len(crowd) < max(MANY, MOST * len(spots)):
        return None
    low, high = crowd.min(axis=0), crowd.max(axis=0)
    frame = np.array([axes.bbox.width, axes.bbox.height])
    if np.any(high - low > SMALL * frame) or np.all(high - low < 0.02 * figure.dpi / 72.0):
        return None  # too wide, or all at one point, which no zoom takes apart
    half = np.maximum(0.5 * (high - low) * 1.45, 0.5 * frame / MOST_ZOOM)
    middle = 0.5 * (low + high)
    ends = axes.transData.inverted().transform([middle - half, middle + half])
    return (float(ends[0, 0]), float(ends[1, 0])), (float(ends[0, 1]), float(ends[1, 1]))


def find_room(axes: Axes, region: Region, obstacles: np.ndarray, taken: Sequence[Box]) -> Box | None:
    """The largest free rectangle of the axes, in axes coordinates (x, y, width, height); None where all are small.

    Parameters
    ----------
    axes : its limits must be final.
    region : what the inset will show; it stays free.
    obstacles : float array (n, 2), data coordinates of points close together on the curves.
    taken : boxes on the page that stay free, such as the legend's.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    frame = axes.bbox
    ground = Ground(frame, axes.transData.transform(np.asarray(obstacles, float).reshape(-1, 2)))
    corners = axes.transData.transform(np.array(region).T)
    boxes = [*taken, (*corners.min(axis=0), *corners.max(axis=0))]
    best: tuple[float, Box] | None = None
    for w in SIZES:
        for h in SIZES:
            wide, high = w * frame.width, h * frame.height
            if wide < LEAST[0] * figure.dpi or high < LEAST[1] * figure.dpi:
                continue
            if best is not None and w * h <= best[0]:
                continue
            places = _places(frame, wide, high)
            free = ground.free(places) & ~np.any([_overlap(places, box) for box in boxes], axis=0)
            if free.any():
                x0, y0, x1, y1 = places[np.argmax(free)].tolist()
                best = w * h, (x0, y0, x1, y1)
    if best is None:
        return None
    x0, y0, x1, y1 = best[1]
    return (
        (x0 - frame.x0) / frame.width,
        (y0 - frame.y0) / frame.height,
        (x1 - x0) / frame.width,
        (y1 - y0) / frame.height,
    )


def _places(frame: Bbox, wide: float, high: float) -> np.ndarray:
    """Boxes of a size all over the axes, shape (n, 4), from the lower left on."""
    edge = 0.012 * frame.width
    xs = np.linspace(frame.x0 + edge, frame.x1 - edge - wide, STEPS)
    ys = np.linspace(frame.y0 + edge, frame.y1 - edge - high, STEPS)
    y, x = (v.ravel() for v in np.meshgrid(ys, xs, indexing="ij"))
    return np.column_stack([x, y, x + wide, y + high])


def _overlap(boxes: np.ndarray, other: Box) -> np.ndarray:
    """Which boxes share something with another one."""
    across = (boxes[:, 0] < other[2]) & (other[0] < boxes[:, 2])
    return across & (boxes[:, 1] < other[3]) & (other[1] < boxes[:, 3])


def add_inset(axes: Axes, region: Region, room: Box, size: float) -> tuple[Axes, list[Any]]:
    """Empty axes with the limits of a region in a free rectangle; a frame and two lines say what they show.

    Parameters
    ----------
    axes : Axes
    region : limits of the inset.
    room : x, y, width, height in axes coordinates, tick labels included.
    size : of the tick labels, in points.

    Returns
    -------
    inset : Axes
    artists : list
        The frame and the lines.
    """
    from matplotlib.patches import ConnectionPatch, Rectangle
    from matplotlib.ticker import MaxNLocator

    figure = axes.get_figure(root=True)
    assert figure is not None
    point = figure.dpi / 72.0
    left, low = 4.2 * size * point / axes.bbox.width, 1.9 * size * point / axes.bbox.height
    x, y, width, height = room
    inset = axes.inset_axes((x + left, y + low, width - left, height - low), zorder=7)
    (x0, x1), (y0, y1) = region
    inset.set(xlim=(x0, x1), ylim=(y0, y1))
    inset.tick_params(labelsize=size, length=2.5, pad=1.5)
    for axis, count in ((inset.xaxis, 3), (inset.yaxis, 4)):
        axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
        axis.get_major_formatter().set_useOffset(False)  # type: ignore[union-attr]
    for spine in inset.spines.values():
        spine.set(visible=True, color="0.45", linewidth=0.7)
    look: dict[str, Any] = {"edgecolor": "0.45", "linewidth": 0.7, "zorder": 1.6}
    frame = axes.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, facecolor="none", **look))
    lines = []
    inner = axes.transAxes.transform([(x + left, y + low), (x + width, y + height)])
    outer = axes.transData.transform([(x0, y0), (x1, y1)])
    for corner in _sides(inner, outer):
        at = (x0, x1)[corner[0]], (y0, y1)[corner[1]]
        line = ConnectionPatch(
            corner, at, "axes fraction", "data", axesA=inset, axesB=axes, color="0.6", lw=0.6
        )
        line.set_zorder(1.6)
        axes.add_artist(line)
        lines.append(line)
    return inset, [frame, *lines]


def outlines(axes: Axes, frame: list[Any]) -> list[np.ndarray]:
    """The lines of :func:`add_inset` in data coordinates of the axes, shape (n, 2) each: no label may stand on them."""
    box, *lines = frame
    (x0, y0), (x1, y1) = box.get_bbox().get_points()
    found = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)])]
    for line in lines:
        corner = axes.transData.inverted().transform(line.axesA.transAxes.transform(line.xy1))
        found.append(np.array([corner, line.xy2]))
    return found


def _sides(inner: np.ndarray, outer: np.ndarray) -> list[tuple[int, int]]:
    """The two corners, one beside the other, whose lines stay outside both rectangles."""
    dx, dy = outer.mean(axis=0) - inner.mean(axis=0)
    if abs(dy) * np.ptp(inner[:, 0]) > abs(dx) * np.ptp(inner[:, 1]):  # one above the other
        return [(0, int(dy > 0)), (1, int(dy > 0))]
    return [(int(dx > 0), 0), (int(dx > 0), 1)]
