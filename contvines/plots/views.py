"""What part of the plane a picture shows: limits that runaway branches do not set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..graph.graph import Graph
    from .curves import Curve

RUNAWAY = (
    6.0  # a range that many times wider than where special points and most points lie is not shown whole
)
MOST = (4.0, 96.0)  # per cent: where most points lie


def frame(
    axes: Axes,
    graph: Graph,
    curves: list[Curve],
    x: str,
    y: str,
    xlim: tuple[float, float] | None,
    ylim: tuple[float, float] | None,
) -> None:
    """Set the limits: the asked ones, else all that is drawn but the far ends of branches that run away."""
    axes.margins(0.04)
    axes.autoscale_view()
    if xlim is not None:
        axes.set_xlim(*xlim)
    if ylim is not None:
        axes.set_ylim(*ylim)
        return
    drawn = [v for curve in curves for _, ys in curve.strands() for v in ys[np.isfinite(ys)]]
    marks = [
        float(v)
        for line in axes.lines
        if len(np.atleast_1d(line.get_ydata())) == 1
        for v in np.atleast_1d(np.asarray(line.get_ydata(), dtype=float))
    ]
    limits = _without_runaways(np.array(drawn), np.array([v for v in marks if np.isfinite(v)]))
    if limits is not None and axes.get_yscale() == "linear":
        axes.set_ylim(*limits)


def _without_runaways(values: np.ndarray, marks: np.ndarray) -> tuple[float, float] | None:
    """Narrower limits where a few points lie far from all others; None where all may be shown."""
    if values.size < 10:
        return None
    inner = np.concatenate([np.percentile(values, MOST), marks])
    low, high = float(inner.min()), float(inner.max())
    room = high - low
    if not room > 0.0 or float(np.ptp(values)) <= RUNAWAY * room:
        return None
    return max(low - 0.5 * room, float(values.min()) - 0.04 * room), min(
        high + 0.5 * room, float(values.max()) + 0.04 * room
    )
