"""Animation of one orbit: moving bodies and walls above, time history with a marker of the current time below."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.animations import animated, check_animation, pictures
from contvines.shared.figures import Style, legend_below, new_figure, styled
from contvines.shared.near_names import hinting
from orbits.plots.portrait import history, phase, title
from orbits.plots.shown import Shown, shown

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

    from orbits.orbit import Orbit

WALL = "0.35"
ROOM = 0.12  # free space at both sides, relative to the range of positions


@hinting
def animate(
    orbit: Orbit,
    path: str | Path | None = None,
    *,
    seconds: float = 3.0,
    rate: int = 20,
    figsize: tuple[float, float] = (6.4, 4.2),
    style: Style = None,
) -> FuncAnimation:
    """Animate the orbit over its period, in a loop.

    The upper panel shows bodies and walls, the lower one all positions (for a declared machine: states) over the period. If no state
    of a declared machine is the rate of another one, the upper panel shows a point on the phase portrait.

    Parameters
    ----------
    orbit : Orbit
    path : path, optional
        File to be written: gif, mp4 (needs ffmpeg) or an html page with a player.
    seconds : float
        Duration of one period in the animation.
    rate : int
        Pictures per second.
    figsize : (float, float)
        Size in inches.
    style : str or mapping, optional
        A style or rcParams of matplotlib, which override those of the package.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        A notebook shows it with a player.

    Raises
    ------
    ValueError
        If the path cannot be written, or `seconds` or `rate` is not positive.
    """
    frames = pictures(seconds, rate)
    if path is not None:
        check_animation(path)
    data = shown(orbit, 4 * frames)
    with styled(style):
        figure = new_figure(figsize)
        figure.suptitle(title(orbit).split("\n")[0], fontsize="medium")
        above, below = figure.subplots(2, 1, height_ratios=(1.0, 1.6))
        even = np.linspace(data.clock[0], data.clock[-1], frames, endpoint=False)
        move = _point(above, data, even, orbit.real) if data.animation is None else _stage(above, data, even)
        history(below, data, orbit.real)
        legend_below(below, below.get_legend_handles_labels()[0], True)
        now = below.axvline(even[0], color="0.2", linewidth=1.0)

        def draw(frame: int) -> None:
            now.set_xdata([even[frame], even[frame]])
            move(frame)

        return animated(figure, draw, path, seconds, rate)


def _stage(axes: Axes, data: Shown, even: np.ndarray) -> Callable[[int], None]:
    """Draw bodies and walls; return a function that moves them to a frame."""
    stage = data.animation or {}
    if "box" in stage:  # samples are evenly spaced over the period
        bodies, walls = {"absorber": stage["body"]}, [stage["box"] - wall for wall in stage["walls"]]
        given = np.linspace(even[0], 2.0 * even[-1] - even[-2], len(stage["box"]))
    else:
        bodies, walls = stage["bodies"], [wall["at"] for wall in stage["walls"]]
        given = data.clock
    places = {name: np.interp(even, given, v) for name, v in bodies.items()}
    edges = [np.interp(even, given, wall) for wall in walls]
    everything = np.concatenate([*places.values(), *edges])
    low, high = float(everything.min()), float(everything.max())
    room = ROOM * ((high - low) or 1.0)
    axes.set_xlim(low - room, high + room)
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_xlabel(data.unit if "box" in stage else "positions")
    axes.axhline(0.3, color="0.8", linewidth=1.0)
    marks, lines = [], []
    for name, v in places.items():
        marks += axes.plot([v[0]], [0.42], "o", markersize=12, color=data.curves[name].colour, label=name)
    for edge in edges:
        lines += axes.plot([edge[0]] * 2, [0.3, 0.8], color=WALL, linewidth=5.0, solid_capstyle="butt")
    if len(places) > 1:
        axes.legend(loc="upper right", fontsize="small", ncols=len(places), frameon=False)

    def move(frame: int) -> None:
        for mark, v in zip(marks, places.values(), strict=True):
            mark.set_xdata([v[frame]])
        for line, edge in zip(lines, edges, strict=True):
            line.set_xdata([edge[frame], edge[frame]])

    return move


def _point(axes: Axes, data: Shown, even: np.ndarray, real: bool) -> Callable[[int], None]:
    """Draw a point on the phase portrait; return a function that moves it to a frame."""
    phase(axes, data, real)
    across, up = (np.interp(even, data.clock, values) for values in (data.x, data.y))
    (mark,) = axes.plot([across[0]], [up[0]], "o", color="0.1", zorder=5)

    def move(frame: int) -> None:
        mark.set_data([across[frame]], [up[frame]])

    return move
