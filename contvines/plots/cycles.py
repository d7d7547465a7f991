"""Picture and animation of a cycle of a flow: phase portrait, and states over a period."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contvines.shared.animations import animated, check_animation, pictures

from ..continuation.settings import hinting
from ..flows.orbit import CycleOrbit
from ..shared.figures import Size, Style, panels
from .style import STATE_COLORS, STATE_OF

SAMPLES = 800


def plot_cycle(
    orbit: CycleOrbit,
    *,
    axes: Axes | None = None,
    figsize: Size = None,
    style: Style = None,
    coordinates: tuple[int, int] = (0, 1),
) -> Figure:
    """Draw the phase portrait of a cycle; a new figure also has the time series of the first four states.

    Parameters
    ----------
    orbit : CycleOrbit
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; given axes get the phase portrait.
    coordinates : (int, int)
        Indices of the states on the x and y axes of the phase portrait. A flow of one state is drawn over time.

    Raises
    ------
    ValueError
        If an index is out of range, or there are not two of them.
    """
    times = np.linspace(0.0, orbit.period, SAMPLES)
    states = orbit(times)
    d = states.shape[1]
    if not (len(coordinates) == 2 and all(0 <= j < max(d, 2) for j in coordinates)):
        raise ValueError(f"coordinates = {coordinates!r} must be two of 0 to {d - 1}")
    path, names = (times, states[:, 0]), ("time", "$x_0$")
    if d > 1:
        path, names = states[:, list(coordinates)].T, tuple(f"$x_{j}$" for j in coordinates)
    size, beside = figsize or (7.2, 3.2), {"mosaic": "ab"}
    with panels(axes, (1,), "a cycle is drawn on", size, style, beside) as (figure, drawn):
        drawn[0].plot(*path, color=STATE_COLORS[STATE_OF[orbit.stable]])
        drawn[0].set(xlabel=names[0], ylabel=names[1])
        for j in range(min(d, 4) if axes is None else 0):
            drawn[1].plot(times, states[:, j], label=f"$x_{j}$")
        if axes is None:
            drawn[1].set(xlabel="time", ylabel="states")
            drawn[1].margins(x=0.0)
            drawn[1].legend(loc="best", fontsize="small")
    return figure


@hinting
def animate_cycle(
    orbit: CycleOrbit,
    path: str | Path | None = None,
    *,
    seconds: float = 3.0,
    rate: int = 20,
    figsize: tuple[float, float] = (7.2, 3.2),
    style: Style = None,
    coordinates: tuple[int, int] = (0, 1),
) -> FuncAnimation:
    """Animate a cycle: a point moves on the phase portrait, a line over the time series.

    Parameters
    ----------
    orbit : CycleOrbit
    path : path, optional
        File to be written: gif, mp4 (needs ffmpeg) or an html page with a player.
    seconds, rate : float, int
        Duration of one period in the animation, and pictures per second.
    figsize, style, coordinates
        As for `plot_cycle`.

    Raises
    ------
    ValueError
        If the path cannot be written, or `seconds` or `rate` is not positive.
    """
    frames = pictures(seconds, rate)
    if path is not None:
        check_animation(path)
    figure = plot_cycle(orbit, figsize=figsize, style=style, coordinates=coordinates)
    times = np.linspace(0.0, orbit.period, frames, endpoint=False)
    states = orbit(times)
    places = (times, states[:, 0]) if states.shape[1] == 1 else states[:, list(coordinates)].T
    left, right = figure.axes[:2]
    (mark,) = left.plot([places[0][0]], [places[1][0]], "o", color="0.1", markersize=6)
    now = right.axvline(0.0, color="0.2", linewidth=1.0)

    def move(frame: int) -> None:
        mark.set_data([places[0][frame]], [places[1][frame]])
        now.set_xdata([times[frame], times[frame]])

    return animated(figure, move, path, seconds, rate)
