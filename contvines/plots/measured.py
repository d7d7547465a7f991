"""Pictures of responses with and without the absorber (transients, spectral densities), and of a calibration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..continuation.settings import hinting
from ..shared.figures import Size, Style, drawing
from .legends import place_legend
from .style import BLUE, RED, REFERENCES, axis_label

NAMES = {"bare": "without absorber", "tuned": "tuned absorber", "oscillator": "with absorber"}
PLAIN = (-2, 3)  # powers of ten between which tick labels have no exponent


@hinting
def plot_transient(
    series: Sequence[tuple[str, str, np.ndarray]],
    hits: np.ndarray | None = None,
    *,
    axes: Axes | None = None,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw displacements, or the energy on a logarithmic axis, with and without the absorber.

    Parameters
    ----------
    series : sequence of (name, unit, values)
        The first one is time. Names that begin with "bare" mean the machine without absorber; those that begin with "relative" are
        not drawn.
    hits : float array, optional
        Times of impacts, drawn as ticks at the lower edge.
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    (clock, second, time), *curves = series
    name, unit, _ = curves[0]
    compared = any(what.startswith("bare") for what, _, _ in curves)
    with drawing(axes, style, figsize) as (figure, axes, own):
        thin = 0.65 * float(rcParams["lines.linewidth"])  # many periods stand side by side
        for what, _, values in curves:
            bare = what.startswith("bare")
            color, dashes = REFERENCES["bare"] if bare else (BLUE, "-")
            look = {"color": color, "linestyle": dashes, "linewidth": thin, "zorder": 1.9 if bare else 2.0}
            label = NAMES["bare" if bare else "oscillator"] if compared else what.replace("_", " ")
            if not what.startswith("relative"):
                axes.plot(time, values, label=label, **look)
        if hits is not None and hits.size:
            ticks: dict[str, Any] = {"marker": "|", "linestyle": "none", "color": RED, "label": "impacts"}
            axes.plot(hits, np.full(hits.size, 0.02), transform=axes.get_xaxis_transform(), **ticks)
        axes.set(xlabel=axis_label(clock, unit=second), ylabel=axis_label(name, unit=unit))
        if name == "energy":
            axes.set(yscale="log", ylabel="energy / initial energy")
        axes.margins(x=0.0)
        place_legend(axes, (), True, own, usual="below")
    return figure


@hinting
def plot_densities(
    frequencies: np.ndarray,
    unit: str,
    densities: Mapping[str, tuple[np.ndarray, str]],
    figsize: Size = None,
) -> Figure:
    """Draw spectral densities of responses over the frequency, on a logarithmic axis.

    Parameters
    ----------
    frequencies : float array (k,)
    unit : str
        Unit of the frequencies.
    densities : mapping
        Name -> values (k,) and unit. "bare": without absorber; "tuned": with a tuned absorber; "oscillator": with the absorber.
    figsize : (float, float), optional
        Size in inches.
    """
    with drawing(None, None, figsize) as (figure, axes, own):
        colors = iter([BLUE, "#2e7d32", "#8e5a00", "#6a1b9a"] * len(densities))
        for name, (values, _) in densities.items():
            color, dashes = REFERENCES.get(name) or (next(colors), "-")
            axes.plot(frequencies, values, color=color, linestyle=dashes, label=NAMES.get(name, name))
        units = {shown for _, shown in densities.values()}
        up = axis_label("density of the response", unit=units.pop() if len(units) == 1 else None)
        axes.set(yscale="log", xlabel=axis_label("frequency", unit=unit), ylabel=up)
        axes.margins(x=0.0)
        place_legend(axes, (), True, own, usual="below")
    return figure


@hinting
def plot_calibration(
    places: np.ndarray,
    residuals: np.ndarray,
    heights: np.ndarray | None = None,
    *,
    xlabel: str,
    ylabel: str,
    axes: Axes | None = None,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw a measured response and the computed one; for impact times their differences.

    Parameters
    ----------
    places : float array (n,)
        Measured times of impacts, or values of the parameter.
    residuals : float array (n,)
        Computed minus measured values.
    heights : float array (n,), optional
        Measured response; None for impact times.
    xlabel, ylabel : str
        Labels of the axes.
    axes, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    with drawing(axes, style, figsize) as (figure, axes, own):
        if heights is None:
            axes.axhline(0.0, color="0.6", linewidth=0.8)
            axes.plot(places, -residuals, linestyle="none", marker="o", color=BLUE)
        else:
            axes.plot(places, heights, linestyle="none", marker="o", color=RED, mfc="none", label="measured")
            axes.plot(places, heights + residuals, color=BLUE, label="with the estimate")
        axes.set(xlabel=xlabel, ylabel=ylabel)
        axes.ticklabel_format(axis="y", scilimits=PLAIN)
        place_legend(axes, (), True, own, usual="below")
    return figure
