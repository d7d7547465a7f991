"""Picture of a survey: a curve over one parameter with bands for the samples, a map with contours over two, or dots for samples alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from ..continuation.settings import hinting
from ..shared.figures import Size, Style, narrower, panels
from ..survey.results import Survey
from .legends import NARROW, place_legend
from .style import BLUE, RED, label_of

BANDS = ((0.0, 1.0, 0.16, "all samples"), (0.025, 0.975, 0.30, "95 %"), (0.25, 0.75, 0.45, "half of them"))


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

    Over one axis: a curve, or for samples their median with bands. Over two axes: a map with contours; for samples it shows the largest value.
    Without axes: a dot per sample over each uncertain parameter.

    Parameters
    ----------
    survey : Survey
    outcome : str, optional
        By default the first.
    axes, legend, figsize, style
        As for `contvines.plots.diagram.plot_diagram`; without axes in the survey, one per uncertain parameter.

    Raises
    ------
    ValueError
        If the outcome is unknown, the survey has more than two axes, or the number of `axes` is not that of the panels.
    """
    if not survey.columns:
        raise ValueError("the survey has no outcome to draw: all of its systems failed; the notes say why")
    name = outcome or next(iter(survey.columns))
    if name not in survey.columns:
        raise ValueError(f"{name}: the survey has no such outcome; it has {', '.join(survey.columns)}")
    along, samples = list(survey.plan.axes), survey.plan.samples
    if len(along) > 2:
        raise ValueError(
            f"a picture shows one or two axes, the survey has {', '.join(along)}; vary fewer at a time"
        )
    count = 1 if along else len(samples)
    if count > 1:
        figsize = figsize or (3.2 * count + 1.0, 3.6)

    beside = {"mosaic": [list(range(count))], "sharey": True}
    with panels(axes, (count,), "this survey is drawn on", figsize, style, beside) as (figure, drawn):
        drawn[0].set_ylabel(label_of(survey, name if len(along) < 2 else along[1]))
        for panel, over in zip(drawn, along or samples):
            panel.set_xlabel(label_of(survey, over))
        if not along:
            for panel, values in zip(drawn, samples.values()):
                panel.plot(values, survey.columns[name], "o", color=BLUE, markersize=3.5)
        elif len(along) == 1:
            _curve(drawn[0], survey, name, survey.plan.axes[along[0]])
        else:
            _map(figure, drawn[0], survey, name, along)
        if along:
            usual = "inside" if len(along) == 1 else "below"  # a map has no room inside
            place_legend(drawn[0], (), legend, axes is None, usual=usual)
            counts = {"failed": survey.failed, "known in part": survey.partly}
            notes = [
                f"{count} of {len(survey.plan)} systems {what}" for what, count in counts.items() if count
            ]
            drawn[0].set_title(", ".join(notes), color="0.4", fontsize="medium")
    return figure


def _curve(axes: Axes, survey: Survey, name: str, x: np.ndarray) -> None:
    values = survey.columns[name]
    if survey.plan.samples:
        for low, high, strength, label in BANDS:
            lower, upper = (_quantile(values, share) for share in (low, high))
            axes.fill_between(x, lower, upper, color=BLUE, alpha=strength, lw=0, label=label)
        axes.plot(x, _quantile(values, 0.5), color=BLUE, label="median")
        return
    axes.plot(x, values, "-", color=BLUE)
    part = survey.notes != ""
    axes.plot(x[~part], values[~part], "o", color=BLUE, markersize=3.5)
    if np.any(part & np.isfinite(values)):
        look: dict[str, Any] = {"mfc": "white", "mec": BLUE, "markersize": 3.5}
        axes.plot(x[part], values[part], "o", label="known in part", **look)


def _quantile(values: np.ndarray, share: float) -> np.ndarray:
    """Return a quantile of the finite numbers in each row; nan if a row has none."""
    rows = (row[np.isfinite(row)] for row in values)
    return np.array([np.quantile(known, share) if known.size else np.nan for known in rows])


def _map(figure: Figure, axes: Axes, survey: Survey, name: str, along: list[str]) -> None:
    """Draw a map with contours, and marks of failed and partly known systems."""
    x, y = (survey.plan.axes[n] for n in along)
    values = survey.columns[name]
    if survey.plan.samples:
        values = np.fmax.reduce(values, axis=-1)  # nan only where no sample has a number
    shown = np.ma.masked_invalid(values.T)
    colours = axes.pcolormesh(x, y, shown, cmap="viridis", shading="nearest", rasterized=True)
    worst = ", worst sample" if survey.plan.samples else ""
    figure.colorbar(colours, ax=axes, label=label_of(survey, name) + worst)
    known = shown.compressed()
    if min(shown.shape) > 1 and known.size and known.max() > known.min():
        levels = 4 if narrower(axes, NARROW) else 7
        lines = axes.contour(x, y, shown, levels=levels, colors="white", linewidths=1.0)
        # the brightest colours hide white lines without an outline
        lines.set(path_effects=[withStroke(linewidth=1.8, foreground="0.35")])
        for text in axes.clabel(lines, fmt="%.4g", fontsize="x-small", inline=False):
            text.set_path_effects([withStroke(linewidth=3.0, foreground="0.25")])
    part = (survey.notes != "") & ~survey.lost
    for label, which, marker, edge in (
        ("failed", survey.lost, "x", RED),
        ("known in part", part, "o", "black"),
    ):
        i, j = np.nonzero(which.reshape(*survey.plan.shape[:2], -1).any(axis=-1))
        if len(i):
            axes.plot(x[i], y[j], marker, label=label, mec=edge, mfc="white")
    axes.grid(False)
