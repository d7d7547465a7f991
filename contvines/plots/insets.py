"""An inset for the most crowded place of a diagram, where the picture has room for one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .figures import pixels
from .labels import Box, Ground, touching

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.inset import InsetIndicator


MANY = 6  # marks that hide one another ask for an inset,
MOST = 0.35  # if they are this part of all marks: a picture crowded everywhere needs its room for labels
NEAR = 11.0  # points on the page: nearer marks hide one another
SMALL = 0.3  # of the axes: a wider crowd is no single place
LEAST = (1.35, 0.95)  # inches: a smaller inset shows nothing
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
    if len(spots) < MANY:
        return None
    page = axes.transData.transform(spots)
    near = (np.hypot(*(page[:, None] - page[None]).T) < NEAR * pixels(axes)).astype(float)
    for _ in range(int(np.ceil(np.log2(len(spots)))) + 1):  # chains of neighbours belong together
        near = (near @ near > 0).astype(float)
    crowd = page[near[int(np.argmax(near.sum(axis=1)))] > 0]
    if len(crowd) < max(MANY, MOST * len(spots)):
        return None
    low, high, frame = crowd.min(axis=0), crowd.max(axis=0), np.ptp(axes.bbox.get_points(), axis=0)
    if np.any(high - low > SMALL * frame) or np.all(high - low < 0.02 * pixels(axes)):
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
        if np.any(extent < np.array(LEAST) * 72.0 * pixels(axes)):
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
