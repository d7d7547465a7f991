"""Invariant circles: the section, and radius and rotation number against the parameter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .figures import new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..circles.circle import Circles


def _roundest(circles: Circles) -> tuple[str, ...]:
    """The two coordinates between which the first harmonic of the last circle encloses most, relative to its extent."""
    if not len(circles):
        return circles.names[:2]
    x = circles[-1].points - circles[-1].points.mean(axis=0)
    first = np.fft.fft(x, axis=0)[1] / np.where(x.std(axis=0) > 0.0, x.std(axis=0), 1.0)
    area = np.triu(np.abs(np.imag(np.outer(first, first.conj()))), 1)
    i, j = np.unravel_index(int(np.argmax(area)), area.shape)
    return circles.names[i], circles.names[j]


def plot_circles(
    circles: Circles,
    coordinates: tuple[str, str] | None = None,
    style: str | Mapping[str, Any] | None = None,
    **options: Any,
) -> Figure:
    """Draw the circles beside a Neimark-Sacker point.

    Parameters
    ----------
    circles : Circles
    coordinates : (str, str), optional
        Which coordinates of the section are drawn across and upright; by default those in which the circles look most like circles.
    style : str or mapping, optional
        As for :func:`contvines.plots.figures.styled`.
    **options
        For the new figure (``figsize``).

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    ValueError
        If the section has no such coordinate, or fewer than two of them.
    """
    names = circles.names
    wanted = _roundest(circles) if coordinates is None else coordinates
    for name in wanted:
        if name not in names:
            raise ValueError(f"coordinates: {name!r} is none of the section's: {', '.join(names)}")
    if len(wanted) != 2:
        raise ValueError("coordinates: give two names")
    i, j = (names.index(name) for name in wanted)
    with styled(style):
        figure, frame = new_axes(None, **{"figsize": (8.2, 3.9), **options})
        frame.remove()
        from matplotlib import colormaps

        grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
        section = figure.add_subplot(grid[:, 0])
        radius = figure.add_subplot(grid[0, 1])
        rotation = figure.add_subplot(grid[1, 1], sharex=radius)
        colors = colormaps["viridis"](np.linspace(0.0, 0.9, max(len(circles), 1)))
        phases = np.linspace(0.0, 2.0 * np.pi, 361)
        for circle, color in zip(circles.circles, colors):
            x = circle.at(phases)
            section.plot(
                x[:, i],
                x[:, j],
                color=color,
                linewidth=0.9,
                linestyle="--" if circle.stable is False else "-",
            )
        section.plot(circles.centre[i], circles.centre[j], "k+", markersize=7)
        section.set_xlabel(wanted[0])
        section.set_ylabel(wanted[1])
        values = np.append(circles.value, circles.values)
        solid = np.append(0.0, circles.radius)
        predicted = np.append(0.0, [circle.predicted for circle in circles.circles])
        radius.plot(values, solid, ".-", color="#0b3c6f", markersize=4, label="circle")
        radius.plot(values, predicted, color="0.5", linestyle=":", label="normal form")
        radius.set_ylabel("radius")
        radius.legend(fontsize="x-small")
        radius.tick_params(labelbottom=False)
        rotation.plot(
            values, np.append(circles.rotation, circles.rotations), ".-", color="#7c3aed", markersize=4
        )
        rotation.set_ylabel("turns per period")
        rotation.set_xlabel(circles.parameter)
        figure.set_layout_engine("constrained")
    return figure
