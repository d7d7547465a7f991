"""Pictures beside a measurement: transients with and without the absorber, and what a calibration leaves over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.settings import hinting
from .figures import Size, Style, drawing, settle
from .legends import place_legend
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

OURS, BARE, DATA = "#0b3c6f", "0.55", "#b5121b"
PLAIN = (-2, 3)  # powers of ten that ticks show in full


@hinting
def plot_transient(
    series: Sequence[tuple[str, str, np.ndarray]],
    hits: np.ndarray | None = None,
    *,
    axes: Axes | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw a motion, or its energy, with the absorber and without.

    Parameters
    ----------
    series : sequence of (name, unit, values)
        The first is time; what is named "bare_..." is without absorber, what is named "relative..." is not drawn. An "energy" has a
        logarithmic axis.
    hits : float array, optional
        Instants of impacts, ticks at the lower edge.
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    from matplotlib import rcParams

    (clock, second, time), *curves = series
    name, unit, _ = curves[0]
    compared = any(what.startswith("bare") for what, _, _ in curves)
    with drawing(axes, style, figsize) as (figure, axes, own):
        thin = 0.65 * float(rcParams["lines.linewidth"])  # many periods stand side by side
        for what, _, values in curves:
            if what.startswith("relative"):
                continue
            bare = what.startswith("bare")
            look: dict[str, Any] = (
                {"color": BARE, "linestyle": (0, (4, 1.5)), "zorder": 1.9} if bare else {"color": OURS}
            )
            label = "without absorber" if bare else "with absorber" if compared else what.replace("_", " ")
            axes.plot(time, values, linewidth=thin, label=label, **look)
        if hits is not None and hits.size:
            low = np.full(hits.size, 0.02)
            ticks: dict[str, Any] = {"marker": "|", "linestyle": "none", "color": DATA, "label": "impacts"}
            axes.plot(hits, low, transform=axes.get_xaxis_transform(), **ticks)
        axes.set(xlabel=axis_label(clock, unit=second), ylabel=axis_label(name, unit=unit))
        if name == "energy":
            axes.set(yscale="log", ylabel="energy / initial energy")
        axes.margins(x=0.0)
        _finish(figure, axes, legend, own)
    return figure


@hinting
def plot_densities(
    frequencies: np.ndarray,
    unit: str,
    densities: Mapping[str, tuple[np.ndarray, str]],
    *,
    axes: Axes | None = None,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw spectral densities of responses over the frequency, logarithmically.

    Parameters
    ----------
    frequencies : float array (k,)
    unit : str
        Of these.
    densities : mapping
        Name -> values (k,) and unit; "bare" and "tuned" are lines to compare with.
    axes, figsize, style
        As for `plot_transient`.
    """
    looks = {
        "bare": (BARE, (0, (4, 1.5)), "without absorber"),
        "tuned": (DATA, (0, (1, 1.6)), "tuned absorber"),
    }
    with drawing(axes, style, figsize) as (figure, axes, own):
        colors = iter([OURS, "#2e7d32", "#8e5a00", "#6a1b9a"] * len(densities))
        for name, (values, _) in densities.items():
            label = "with absorber" if name == "oscillator" else name
            color, line, label = looks.get(name) or (next(colors), "-", label)
            axes.plot(frequencies, values, color=color, linestyle=line, label=label)
        units = {shown for _, shown in densities.values()}
        axes.set(
            yscale="log",
            xlabel=axis_label("frequency", unit=unit),
            ylabel=axis_label("density of the response", unit=units.pop() if len(units) == 1 else None),
        )
        axes.margins(x=0.0)
        _finish(figure, axes, True, own)
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
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw a measured response and the computed one, or, of impact times, what is left over.

    Parameters
    ----------
    places : float array (n,)
        Instants of impacts, or values of the parameter that was swept.
    residuals : float array (n,)
        Computed less measured.
    heights : float array (n,), optional
        The measured response.
    xlabel, ylabel : str
    axes, legend, figsize, style
        As for :func:`contvines.plots.diagram.plot_diagram`.
    """
    with drawing(axes, style, figsize) as (figure, axes, own):
        if heights is None:
            axes.axhline(0.0, color="0.6", linewidth=0.8)
            axes.plot(places, -residuals, linestyle="none", marker="o", color=OURS)
        else:
            axes.plot(places, heights, linestyle="none", marker="o", color=DATA, mfc="none", label="measured")
            axes.plot(places, heights + residuals, color=OURS, label="with the estimate")
        axes.set(xlabel=xlabel, ylabel=ylabel)
        axes.ticklabel_format(axis="y", scilimits=PLAIN)
        _finish(figure, axes, legend, own)
    return figure


def _finish(figure: Figure, axes: Axes, legend: bool | str, own: bool) -> None:
    place_legend(axes, None, legend, own, usual="below")
    if own:
        settle(figure)
        label = axes.yaxis.label
        if label.get_window_extent().height > axes.bbox.height:  # two lines where one is longer than the axis
            words = label.get_text().split()
            halves = [(" ".join(words[:k]), " ".join(words[k:])) for k in range(len(words))]
            axes.set_ylabel("\n".join(min(halves, key=lambda pair: abs(len(pair[0]) - len(pair[1])))))
