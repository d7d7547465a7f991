"""Picture of basins of attraction: a plane of starts, coloured by attractor."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..coexistence.basins import Basins
from ..continuation.settings import hinting
from ..graph.table import told_apart
from ..shared.figures import Size, Style, drawing
from ..shared.numbers import figures
from .legends import place_legend
from .style import axis_label

# the first colours also differ in lightness
COLORS = ("#1f5c87", "#efb04e", "#5f2570", "#58a868", "#c0483f", "#8a8a8a", "#17807e", "#c77dab")
COLORS += ("#b8b042", "#5b6fd6", "#4d4d4d", "#8fcf8a")
NAMED = 3  # largest number of manifolds named in the legend
IMAGE = 0.45  # part of the way from a basin's colour to white for the basin of its mirror image


@hinting
def plot_basins(
    basins: Basins,
    *,
    axes: Axes | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the plane of starts, each in the colour of its attractor; the mirror image of an attractor has a lighter colour.

    Parameters
    ----------
    basins : Basins
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    base = np.resize([to_rgb(color) for color in COLORS], (max(len(basins.attractors), 1), 3))
    base[[k for k, one in enumerate(basins.attractors) if one.kind == "impossible"]] = 0.9  # in a wall: grey
    light = base + IMAGE * (1.0 - base)
    picture = np.where(basins.mirrored[..., None], light[basins.index], base[basins.index])
    with drawing(axes, style, figsize) as (figure, axes, own):
        axes.grid(False)
        x, y = (basins.shown(name, v) for name, v in zip(basins.axes, (basins.x, basins.y)))
        half_x, half_y = (0.5 * (v[1] - v[0]) for v in (x, y))
        extent = (x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y)
        axes.imshow(picture, origin="lower", extent=extent, aspect="auto", interpolation="nearest")
        for curve in basins.manifolds:
            places = (basins.shown(name, v) for name, v in zip(basins.axes, curve.points.T))
            axes.plot(*places, color="black", linewidth=0.8)
        axes.set_xlim(extent[:2])
        axes.set_ylim(extent[2:])
        if basins.axes[0] == basins.leftward:
            axes.invert_xaxis()
        units = {name: unit for name, (_, unit) in basins.gauges.items()}
        across, up = (axis_label(name, units.get(name), basins.notation) for name in basins.axes)
        axes.set(xlabel=across, ylabel=up)
        axes.set_title(f"{axis_label(basins.parameter)} = {figures(basins.value)} {basins.unit}".rstrip())
        if legend:
            entries = []
            for k, about in enumerate(basins.attractors):
                name, _, state = basins.told(k, 20).partition(" through ")
                through = f"\nthrough {state}".replace(", ", ",\n") if state else ""
                cycles = f", k={about.periods}" if about.periods > 1 else ""
                entries.append(Patch(color=base[k], label=f"{name}{cycles}: {about.share:.1%}{through}"))
                if 0.0 < about.mirror_share < about.share:
                    entries.append(Patch(color=light[k], label=f"{name}, mirror image"))
            if basins.manifolds:
                words = list(told_apart((curve.word for curve in basins.manifolds), 20).values())
                few, left = ", ".join(words[:NAMED]), len(words) - NAMED
                label = f"manifolds of {few}" + (f"\nand {left} more" if left > 0 else "")
                entries.append(Line2D([], [], color="black", linewidth=0.8, label=label))
            place_legend(axes, entries, legend, own, usual="beside")
    return figure
