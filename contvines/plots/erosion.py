"""Picture of erosion curves: smallest kick and share of starts over the parameter."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..coexistence.erosion import Erosion
from ..continuation.settings import hinting
from ..graph.table import short_word
from ..shared.figures import Size, Style, drawing
from .legends import place_legend
from .style import axis_label

KICK, SHARE = "#2a6f97", "#e9a23b"


@hinting
def plot_erosion(
    erosion: Erosion,
    *,
    axes: Axes | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the smallest kick that leads to another motion, and on a second axis the share of starts with its confidence interval.

    Parameters
    ----------
    erosion : Erosion
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    with drawing(axes, style, figsize) as (figure, axes, own):
        values = erosion.values
        beside = axes.twinx()
        beside.grid(False)
        beside.spines.right.set_visible(True)
        beside.set_ylim(0.0, 1.0)
        beside.set_ylabel("share of starts")
        low, high = np.array([one.share_interval for one in erosion.entries]).T
        (shares,) = beside.plot(values, erosion.shares, color=SHARE, marker=".", label="share of starts")
        beside.fill_between(values, low, high, color=SHARE, alpha=0.25, linewidth=0.0)
        (kicks,) = axes.plot(values, erosion.distances, "o-", color=KICK)
        kicks.set_label("smallest kick that leads elsewhere")
        axes.set_ylim(bottom=0.0)
        axes.set_zorder(beside.get_zorder() + 1)
        axes.patch.set_visible(False)
        axes.set_xlabel(axis_label(erosion.parameter, unit=erosion.unit, notation=erosion.notation))
        axes.set_ylabel("smallest kick")
        axes.set_title(f"{erosion.label}: {short_word(erosion.word)}" if erosion.word else erosion.label)
        place_legend(axes, [kicks, shares], legend, own, usual="below")
    return figure
