"""Pictures of surveys: a curve over one parameter with bands of what is uncertain, a map over two with contours."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..continuation.settings import hinting
from .figures import (
    Size,
    Style,
    given_axes,
    narrower,
    new_axes,
    new_figure,
    pixels,
    settle,
    styled,
    thin_ticks,
)
from .legends import NARROW, place_legend
from .style import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

    from ..survey.results import Survey

BANDS = ((0.0, 1.0, 0.16, "all samples"), (0.025, 0.975, 0.30, "95 %"), (0.25, 0.75, 0.45, "half of them"))
BLUE, RED = "#0b3c6f", "#b5121b"


@hinting
def plot_survey(
    survey: Survey,
    outcome: str | None = None,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw an outcome of a survey.

    Over one axis: a curve; with samples their median and bands. Over two axes: a map with contours, with samples of their worst
    (largest) value. Samples alone: a dot per sample over each uncertain parameter.

    Parameters
    ----------
    survey : Survey
    outcome : str, optional
        By default the first.
    axes, legend, figsize, style
        As for `contvines.plots.diagram.plot_diagram`; samples alone need as many axes as there are uncertain parameters.

    Raises
    ------
    ValueError
        If there is no such outcome, more than two axes vary, or `axes` are not as many as there are panels.
    """
    if not survey.columns:
        raise ValueError("the survey has no outcome to draw: all of its systems failed; the notes say why")
    name = outcome or next(iter(survey.columns))
    if name not in survey.columns:
        raise ValueError(f"{name}: the survey has no such outcome; it has {', '.join(survey.columns)}")
    along = list(survey.plan.axes)
    if len(along) > 2:
        raise ValueError(
            f"a picture shows one or two axes, the survey has {', '.join(along)}; vary fewer at a time"
        )
    with styled(style):
        if not along:
            return _samples(survey, name, axes, figsize)
        own = axes is None
        figure, (panel,) = _panels(axes, 1, figsize)
        heights: list[Text] = []
        if len(along) == 1:
            _curve(panel, survey, name, along[0])
        else:
            heights = _map(figure, panel, survey, name, along)
        place_legend(panel, None, legend, own)
        counts = {"failed": survey.failed, "known in part": survey.partly}
        said = [f"{count} of {len(survey.plan)} systems {what}" for what, count in counts.items() if count]
        if said:
            panel.set_title(", ".join(said), color="0.4", fontsize="medium")
        if own:
            _fit(figure)
        if heights:
            _apart(figure, heights)
    return figure


def _apart(figure: Figure, texts: list[Text]) -> None:
    """Leave out texts that would stand on one another."""
    settle(figure)
    kept: list[Bbox] = []
    for text in texts:
        box = text.get_window_extent().padded(2.0)
        if any(box.overlaps(other) for other in kept):
            text.remove()
        else:
            kept.append(box)


def _panels(axes: Axes | Sequence[Axes] | None, count: int, figsize: Size) -> tuple[Figure, list[Axes]]:
    """The axes given, or those of a new figure, side by side."""
    if axes is not None:
        return given_axes(axes, (count,), "this survey is drawn on")
    if count == 1:
        figure, one = new_axes(None, figsize)
        return figure, [one]
    figure = new_figure(figsize=figsize or (3.2 * count + 1.0, 3.6))
    return figure, list(figure.subplots(1, count, sharey=True))


def _fit(figure: Figure) -> None:
    """Break what goes upward for the height that the axes have at last, and thin out ticks."""
    settle(figure)
    for axes in figure.axes:
        if axes.get_ylabel():
            axes.set_ylabel(_upright(axes, axes.get_ylabel().replace("\n", " ")))
        if axes.get_xlabel():
            axes.set_xlabel(_broken(axes, axes.get_xlabel(), axes.bbox.width))
    settle(figure)
    thin_ticks(*figure.axes)


def label_of(survey: Survey, name: str) -> str:
    """An axis label: outcomes in words."""
    words = {
        "peak": "largest response, worst of the coexisting",
        "lower_peak": "largest response, best of the coexisting",
        "peak_at": "where the largest response is",
        "covered": "share of the interval with a stable response",
    }
    unit = survey.units.get(name, "")
    if name in words:
        return f"{words[name]} [{unit}]" if unit else words[name]
    return axis_label(name, unit=unit, notation=survey.notation)


def _upright(axes: Axes, label: str) -> str:
    """A label that goes upward, on as many lines as the height of the axes asks for."""
    return _broken(axes, label, axes.bbox.height)


def _broken(axes: Axes, label: str, room: float) -> str:
    """A label on lines that have room in so many pixels; a unit stays with the word before it."""
    letters = int(room / pixels(axes) / (0.56 * float(axes.xaxis.label.get_fontsize())))
    lines = textwrap.wrap(label.replace(" [", "\u00a0["), max(12, letters), break_on_hyphens=False)
    return "\n".join(lines).replace("\u00a0", " ")


def _curve(axes: Axes, survey: Survey, name: str, over: str) -> None:
    x, values = survey.plan.axes[over], survey.columns[name]
    if survey.plan.samples:
        known = np.where(np.isfinite(values), values, np.nan)
        for low, high, strength, label in BANDS:
            lower, upper = _quantiles(known, (low, high))
            axes.fill_between(x, lower, upper, color=BLUE, alpha=strength, lw=0, label=label)
        axes.plot(x, _quantiles(known, (0.5,))[0], color=BLUE, label="median")
    else:
        axes.plot(x, values, "-", color=BLUE)
        part = survey.notes != ""
        axes.plot(x[~part], values[~part], "o", color=BLUE, markersize=3.5)
        if np.any(part & np.isfinite(values)):
            look: dict[str, Any] = {"mfc": "white", "mec": BLUE, "markersize": 3.5}
            axes.plot(x[part], values[part], "o", label="known in part", **look)
    axes.set_xlabel(label_of(survey, over))
    axes.set_ylabel(_upright(axes, label_of(survey, name)))


def _quantiles(values: np.ndarray, shares: tuple[float, ...]) -> np.ndarray:
    """Quantiles of the numbers in each row; no number where a row has none."""
    found = np.full((len(shares), len(values)), np.nan)
    for i, row in enumerate(values):
        known = row[np.isfinite(row)]
        if known.size:
            found[:, i] = np.quantile(known, shares)
    return found


def _map(figure: Figure, axes: Axes, survey: Survey, name: str, along: list[str]) -> list[Text]:
    """Draw the map; the numbers that are written on its contours."""
    from matplotlib.patheffects import withStroke

    x, y = (survey.plan.axes[n] for n in along)
    values = survey.columns[name]
    if survey.plan.samples:
        largest = np.nan_to_num(values, nan=-np.inf).max(axis=-1)
        values = np.where(np.isnan(values).all(axis=-1), np.nan, largest)
    shown = np.ma.masked_invalid(values.T)
    colours = axes.pcolormesh(x, y, shown, cmap="viridis", shading="nearest", rasterized=True)
    bar = figure.colorbar(colours, ax=axes)
    bar.set_label(_upright(axes, label_of(survey, name) + (", worst sample" if survey.plan.samples else "")))
    known = shown.compressed()
    heights: list[Text] = []
    if min(shown.shape) > 1 and known.size and known.max() > known.min():
        levels = 4 if narrower(axes, NARROW) else 7
        lines = axes.contour(x, y, shown, levels=levels, colors="white", linewidths=1.0)
        # white alone could not be seen on the brightest colours
        lines.set(path_effects=[withStroke(linewidth=1.8, foreground="0.35")])
        heights = list(axes.clabel(lines, fmt="%.4g", fontsize="x-small", inline=False))
        for text in heights:
            text.set_path_effects([withStroke(linewidth=3.0, foreground="0.25")])
    part = (survey.notes != "") & ~survey.lost
    marks: list[tuple[str, np.ndarray, dict[str, Any]]]
    marks = [("failed", survey.lost, {"marker": "x", "color": RED})]
    marks += [("known in part", part, {"marker": "o", "mfc": "none", "mec": "white"})]
    for label, which, look in marks:
        here = np.argwhere(which.reshape(*survey.plan.shape[:2], -1).any(axis=-1))
        if len(here):
            axes.plot(x[here[:, 0]], y[here[:, 1]], label=label, linestyle="none", **look)
    axes.set_xlabel(label_of(survey, along[0]))
    axes.set_ylabel(_upright(axes, label_of(survey, along[1])))
    axes.grid(False)
    return heights


def _samples(survey: Survey, name: str, axes: Axes | Sequence[Axes] | None, figsize: Size) -> Figure:
    drawn = survey.plan.samples
    figure, panels = _panels(axes, len(drawn), figsize)
    for panel, (parameter, values) in zip(panels, drawn.items(), strict=True):
        panel.plot(values, survey.columns[name], "o", color=BLUE, markersize=3.5)
        panel.set_xlabel(label_of(survey, parameter))
    panels[0].set_ylabel(_upright(panels[0], label_of(survey, name)))
    if axes is None:
        _fit(figure)
    return figure
