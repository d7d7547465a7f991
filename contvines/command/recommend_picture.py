"""The picture of a recommendation: the worst response over what was chosen, and the responses at the choice."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from contvines.command.compare import LOOKS
from contvines.command.recommendation import Recommendation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, RED, GREY = "#0b3c6f", "#b5121b", "0.45"
SIZE, REPORT = (10.0, 4.0), (9.0, 3.4)  # inches
PART = 0.6  # of the height for the start-up
ROOM = 1.3  # of the vertical axis beside the largest number: for the legend


def choice_picture(found: Recommendation, size: tuple[float, float] | None = None) -> Figure:
    """Both panels, one above the other in a narrow picture; where nothing was chosen the first alone."""
    from contvines.plots.figures import new_figure, settle, styled, thin_ticks
    from contvines.plots.legends import NARROW

    with styled():
        figure = new_figure(figsize=size or SIZE)
        count = 2 if found.curves else 1
        across = 1 if figure.get_figwidth() < NARROW else count
        panels = figure.subplots(count // across, across, squeeze=False).ravel()
        draw_places(panels[0], found)
        if found.curves:
            draw_responses(panels[1], found)
        settle(figure)
        thin_ticks(*panels)
    return figure


def _label(found: Recommendation, name: str, text: str) -> str:
    unit = found.units.get(name, "")
    return f"{text} [{unit}]" if unit else text


def draw_places(axes: Axes, found: Recommendation) -> None:
    """The worst response over the value that is chosen."""
    first = [p for p in found.places if p.samples < found.most or found.most == 1]
    later = [p for p in found.places if p.samples == found.most > 1]
    for places, mark, label in (
        (first, "o", "the study's machine"),
        ([p for p in later if not p.left], "D", f"worst of {found.most} samples"),
        ([p for p in later if p.left], "^", "at least: one sample"),
    ):
        known = [(p.value, p.worst) for p in places if math.isfinite(p.worst)]
        if known:
            axes.plot(
                *zip(*known),
                mark,
                color=BLUE,
                markersize=4,
                mfc=BLUE if mark == "D" else "white",
                label=label,
            )
    hidden = [p.value for p in found.places if p.unknown]
    if hidden:
        axes.plot(hidden, np.zeros(len(hidden)), "x", color=GREY, label="not known")
    for kind, (value, _) in found.compared.items():
        color, dashes = LOOKS[kind]
        axes.axhline(value, color=color, linestyle=dashes, linewidth=1.2, label=kind)
    if found.value is not None and found.chosen is not None:
        axes.axvspan(
            *found.tolerance, color=RED, alpha=0.1, lw=0, label=f"costs less than {100 * found.cost:g} %"
        )
        axes.plot(
            found.value, found.chosen.worst, "*", color=RED, markersize=13, mec="white", label="recommended"
        )
    if found.own is not None:
        axes.axvline(found.own, color=GREY, lw=0.9, ls=(0, (3, 3)), label="in the study")
    axes.set(
        xlabel=_label(found, found.name, found.name.replace("_", "-")),
        ylabel=_label(found, "peak", "largest response"),
        ylim=(0.0, None),
    )
    axes.margins(y=0.1)
    axes.legend(loc="best", fontsize="x-small")


def draw_responses(axes: Axes, found: Recommendation) -> None:
    """The responses at the choice beside those to compare with."""
    from orbits.design.references import NAMES

    for curve in found.curves:
        if curve.name in LOOKS:
            color, dashes = LOOKS[curve.name]
            axes.plot(curve.x, curve.y, color=color, linestyle=dashes, linewidth=1.2, label=NAMES[curve.name])
    for name, style in (
        ("simulated", {"marker": ".", "ls": "", "ms": 2.5, "color": "0.35"}),
        ("stable", {"color": BLUE, "lw": 1.8}),
    ):
        said = {"simulated": "simulation up and down", "stable": "recommended: stable motions"}[name]
        for curve in (c for c in found.curves if c.name == name):
            axes.plot(curve.x, curve.y, label=said, **style)
            said = "_"
    axes.set(
        xlabel=_label(found, found.parameter, found.parameter.replace("_", " ")),
        ylabel=_label(found, "peak", "largest displacement"),
        ylim=(0.0, ROOM * max(max(curve.y) for curve in found.curves)),
        xlim=found.within,
    )
    columns = min(2, max(1, len(axes.get_legend_handles_labels()[0]) // 2))
    axes.legend(loc="upper center", ncols=columns, fontsize="x-small", handlelength=2.1, columnspacing=0.5)


def draw_start_up(axes: Axes, found: Recommendation) -> None:
    """The start-up from rest, with the absorber and without."""
    assert found.start_up is not None
    series = found.start_up.series
    axes.plot(series["time"], series["bare"], color=LOOKS["bare"][0], lw=0.6, label="bare oscillator")
    axes.plot(series["time"], series["oscillator"], color=BLUE, lw=0.6, label="recommended")
    axes.set(
        xlabel=_label(found, "time", "time"),
        ylabel=_label(found, "peak", "displacement"),
        xlim=(0.0, series["time"][-1]),
    )
    axes.legend(loc="lower right", fontsize="x-small")


def report_pictures(found: Recommendation) -> list[tuple[Figure, str]]:
    """The pictures of the report with their captions."""
    from contvines.plots.figures import new_figure, settle, styled, thin_ticks

    pictures = [
        (
            choice_picture(found, REPORT),
            "Left: the largest response over the value that is chosen. Right: responses at the choice; where two solid lines run side by side, the machine's past decides.",
        )
    ]
    if found.start_up is not None and found.start_up.series:
        with styled():
            figure = new_figure(figsize=(REPORT[0], REPORT[1] * PART))
            axes = figure.add_subplot()
            draw_start_up(axes, found)
            settle(figure)
            thin_ticks(axes)
        pictures.append((figure, f"Start-up from rest; {found.start_up_at}."))
    return pictures
