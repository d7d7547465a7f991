"""Picture of invariant circles: the section, and radius and rotation number over the parameter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..circles.circle import Circles
from ..continuation.settings import hinting
from ..shared.figures import Size, Style, panels
from .legends import place_legend
from .style import BLUE, axis_label


def _roundest(circles: Circles) -> tuple[str, ...]:
    """Return the two coordinates in whose plane the first harmonic of the last circle encloses the largest area, relative to the extent of the circle."""
    if not len(circles):
        return circles.names[:2]
    x = circles[-1].points - circles[-1].points.mean(axis=0)
    first = np.fft.fft(x, axis=0)[1] / np.where(x.std(axis=0) > 0.0, x.std(axis=0), 1.0)
    area = np.triu(np.abs(np.imag(np.outer(first, first.conj()))), 1)
    i, j = np.unravel_index(int(np.argmax(area)), area.shape)
    return circles.names[i], circles.names[j]


@hinting
def plot_circles(
    circles: Circles,
    coordinates: tuple[str, str] | None = None,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the circles that leave a Neimark-Sacker point.

    Parameters
    ----------
    circles : Circles
    coordinates : (str, str), optional
        Coordinates of the section on the x and y axes; by default those in which the circles are roundest.
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`; one of them for the section, or three for section, radius and
        rotation number. A small new figure has the section only.

    Raises
    ------
    ValueError
        If a coordinate is unknown, the number of coordinates is not two, or the number of axes is neither one nor three.
    """
    names = circles.names
    wanted = _roundest(circles) if coordinates is None else coordinates
    for name in wanted:
        if name not in names:
            raise ValueError(f"coordinates: {name!r} is none of the section's: {', '.join(names)}")
    if len(wanted) != 2:
        raise ValueError("coordinates: give two names")
    i, j = (names.index(name) for name in wanted)

    colors = colormaps["viridis"](np.linspace(0.0, 0.9, max(len(circles), 1)))
    beside = {"mosaic": "ab;ac", "width_ratios": (1.25, 1.0)}
    below = {"mosaic": "a;b;c", "height_ratios": (2.0, 1.0, 1.0)}
    what, size = "circles are drawn on", figsize or (8.2, 3.9)
    with panels(axes, (1, 3), what, size, style, beside, below) as (figure, drawn):
        _section(drawn[0], circles, (i, j), colors)
        if len(drawn) == 3:
            if axes is None:
                drawn[2].sharex(drawn[1])
                drawn[1].tick_params(labelbottom=False)
            _sizes(drawn[1], drawn[2], circles, colors)
            place_legend(drawn[1], (), legend, False)
    return figure


def _section(axes: Axes, circles: Circles, pair: tuple[int, int], colors: np.ndarray) -> None:
    """Draw the circles on the section, larger ones lighter, repelling ones dashed."""
    phases = np.linspace(0.0, 2.0 * np.pi, 361)
    for circle, color in zip(circles.circles, colors):
        x = circle.at(phases)[:, pair]
        axes.plot(*x.T, color=color, linewidth=0.9, linestyle="--" if circle.stable is False else "-")
    axes.plot(*(circles.centre[k] for k in pair), "k+", markersize=7)
    across, up = (axis_label(circles.names[k], notation=circles.notation) for k in pair)
    axes.set(xlabel=across, ylabel=up)
    if any(circle.stable is False for circle in circles.circles):
        axes.set_title("dashed: repelling", loc="left", fontsize="medium")


def _sizes(radius: Axes, rotation: Axes, circles: Circles, colors: np.ndarray) -> None:
    """Draw the radius, with that of the normal form, and the turns per period over the parameter."""
    values = np.append(circles.value, circles.values)
    predicted = np.append(0.0, [circle.predicted for circle in circles.circles])
    look = {"marker": ".", "markersize": 4}
    radius.plot(values, np.append(0.0, circles.radius), color=BLUE, label="circle", **look)
    for value, size, color in zip(circles.values, circles.radius, colors):
        radius.plot([value], [size], "o", color=color, markersize=4.5, zorder=4)  # colours of the section
    radius.plot(values, predicted, color="0.5", linestyle=":", label="normal form")
    radius.set_ylabel("radius")
    rotation.plot(values, np.append(circles.rotation, circles.rotations), color="#7c3aed", **look)
    across = axis_label(circles.parameter, circles.units.get(circles.parameter), circles.notation)
    rotation.set(xlabel=across, ylabel="turns per period")
