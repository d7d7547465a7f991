"""What part of the plane a picture shows: limits that runaway branches do not set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..shared.floating_point import TINY
from .settings import DRAWING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .curves import Curve

RUNAWAY = 6.0  # a range so many times wider than where special points and most points lie is not shown whole
UPRIGHT = 1e-6  # part of the width of a picture: a line that is narrower stands upright
MOST = (4.0, 96.0)  # per cent: where most points lie


def frame(
    axes: Axes, curves: list[Curve], xlim: tuple[float, float] | None, ylim: tuple[float, float] | None
) -> None:
    """Set the limits: the asked ones, else all that is drawn but the far ends of branches that run away.

    Where only the interval across is asked for, the height is that of what is seen in it.
    """
    axes.margins(0.04)
    axes.autoscale_view()
    if xlim is not None:
        axes.set_xlim(*xlim)
    if ylim is not None:
        axes.set_ylim(*ylim)
        return
    if xlim is not None:
        fit_height(axes)
        return
    drawn = [v for curve in curves for _, ys in curve.strands() for v in ys[np.isfinite(ys)]]
    heights = [np.atleast_1d(np.asarray(line.get_ydata(), dtype=float)) for line in axes.lines]
    marks = [float(one[0]) for one in heights if len(one) == 1 and np.isfinite(one[0])]
    limits = _without_runaways(np.array(drawn), np.array(marks), _leaning(curves, axes.get_xlim()))
    if limits is not None and axes.get_yscale() == "linear":
        axes.set_ylim(*limits)


def fit_height(axes: Axes) -> None:
    """Make the axes as high as the lines between their limits across; as they are where there are none."""
    left, right = sorted(axes.get_xlim())
    seen: list[np.ndarray] = []
    for line in axes.lines:
        if not line.get_transform().contains_branch(axes.transData):
            continue
        x, y = (np.asarray(v, dtype=float) for v in line.get_data())
        seen.append(y[(x >= left) & (x <= right) & np.isfinite(y)])
        if len(x) < 2 or line.get_linestyle() in ("None", "none", ""):
            continue
        for edge in (left, right):  # where a line crosses an edge of what is seen
            first = np.flatnonzero((np.minimum(x[:-1], x[1:]) < edge) & (np.maximum(x[:-1], x[1:]) > edge))
            share = (edge - x[first]) / (x[first + 1] - x[first])
            seen.append(y[first] + share * (y[first + 1] - y[first]))
    values = np.concatenate([np.empty(0), *seen])
    values = values[np.isfinite(values)]
    if not values.size:
        return
    low, high = float(values.min()), float(values.max())
    if axes.get_yscale() == "log":
        axes.set_ylim(low / (high / low) ** 0.06, high * (high / low) ** 0.06)
        return
    room = high - low
    least = DRAWING.slack * max(abs(low), abs(high), TINY)  # a level line has a height of its own
    pad = 0.06 * room if room > least else 0.05 * max(abs(low), abs(high)) or 1.0
    limits = None if values.size < 10 else _without_runaways(values, np.empty(0))
    axes.set_ylim(*(limits or (low - pad, high + pad)))


def _leaning(curves: list[Curve], limits: tuple[float, float]) -> np.ndarray:
    """Heights along all branches but those that stand upright, as families of cycles at one value of the parameter, which have all amplitudes."""
    strands = [strand for curve in curves for strand in curve.strands()]
    least = UPRIGHT * abs(limits[1] - limits[0])
    kept = [ys[np.isfinite(ys)] for xs, ys in strands if xs.size and np.nanmax(xs) - np.nanmin(xs) > least]
    return np.concatenate([np.empty(0), *kept])


def _without_runaways(
    values: np.ndarray, marks: np.ndarray, most: np.ndarray | None = None
) -> tuple[float, float] | None:
    """Narrower limits where a few points, or those that are not among `most`, lie far from all others; None where all may be shown."""
    if values.size < 10:
        return None
    typical = values if most is None or most.size < 10 else most
    inner = np.concatenate([np.percentile(typical, MOST), marks])
    low, high = float(inner.min()), float(inner.max())
    room = high - low
    if not room > 0.0 or float(np.ptp(values)) <= RUNAWAY * room:
        return None
    least, largest = float(values.min()), float(values.max())
    return max(low - 0.5 * room, least - 0.04 * room), min(high + 0.5 * room, largest + 0.04 * room)
