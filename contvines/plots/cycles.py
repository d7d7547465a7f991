"""One cycle of a flow: its states over a period, and its phase portrait."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .figures import new_axes, styled
from .style import STATE_COLORS, STATE_OF

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SAMPLES = 800


def plot_cycle(
    orbit: Any,
    *,
    axes: Axes | None = None,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
    coordinates: tuple[int, int] = (0, 1),
) -> Figure:
    """Draw a cycle: the phase portrait, with the time series beside it in a figure of its own.

    Parameters
    ----------
    orbit : CycleOrbit
    axes : Axes, optional
        For the phase portrait alone.
    figsize : (float, float), optional
        In inches.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the house's.
    coordinates : (int, int)
        Of the phase portrait; of a single state, the state over time.

    Raises
    ------
    ValueError
        If the flow has no such coordinates.
    """
    times = np.linspace(0.0, orbit.period, SAMPLES)
    states = orbit(times)
    d = states.shape[1]
    if not (len(coordinates) == 2 and all(0 <= j < max(d, 2) for j in coordinates)):
        raise ValueError(f"coordinates = {coordinates!r} must be two of 0 to {d - 1}")
    color = STATE_COLORS[STATE_OF[orbit.stable]]
    with styled(style):
        if axes is not None:
            figure, axes = new_axes(axes)
            _portrait(axes, times, states, coordinates, color)
            return figure
        figure, left = new_axes(None, figsize=figsize or (7.2, 3.2))
        left.remove()
        left, right = figure.subplots(1, 2)
        _portrait(left, times, states, coordinates, color)
        for j in range(min(d, 4)):
            right.plot(times, states[:, j], label=f"$x_{j}$")
        right.set_xlabel("time")
        right.set_ylabel("states")
        right.margins(x=0.0)
        right.legend(loc="best", fontsize="small")
    return figure


def _portrait(
    axes: Axes, times: np.ndarray, states: np.ndarray, coordinates: tuple[int, int], color: str
) -> None:
    if states.shape[1] == 1:
        axes.plot(times, states[:, 0], color=color)
        axes.set_xlabel("time")
        axes.set_ylabel("$x_0$")
        return
    i, j = coordinates
    axes.plot(states[:, i], states[:, j], color=color)
    axes.set_xlabel(f"$x_{i}$")
    axes.set_ylabel(f"$x_{j}$")
