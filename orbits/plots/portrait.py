"""Phase portrait and time history of one orbit with its events, and its description for headings and notebooks."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.figures import LOW, NARROW, Size, Style, legend_below, panels
from contvines.shared.near_names import hinting
from contvines.shared.numbers import complex_figures, figures
from orbits.machines.measures import sign
from orbits.plots.shown import CAVITY, LINE, Shown, quantities, shown
from orbits.settings import SIMULATING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.orbit import Orbit


PANELS = ("both", "phase", "history")
WALL = "#d9d9d9"
MARKER = {"color": "white", "mec": "black", "mew": 1.0, "ms": 6, "ls": "none", "zorder": 4}


@hinting
def portrait(
    orbit: Orbit,
    points: int = 1200,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    show: str | None = None,
    heading: bool = True,
    legend: bool | str = True,
    figsize: Size = None,
    style: Style = None,
) -> Figure:
    """Draw the phase portrait and the time history of an orbit.

    For a built-in machine: w' against w (left wall on the left), and positions over forcing periods. For a declared machine: the second state
    against the first, and all states over time.

    Parameters
    ----------
    orbit : Orbit
    points : int
        Samples over the period.
    axes : Axes or two of them, optional
        Axes for the phase portrait (with `show` = "history": the history), or for both. Default: a new figure.
    show : {"both", "phase", "history"}, optional
        Default: both; in a small figure the phase portrait.
    heading : bool
        Write a title above a new figure.
    legend : bool or str
        Whether the history has a legend, or its place: "below", or a location of matplotlib.
    figsize : (float, float), optional
        Size of a new figure in inches.
    style : str or mapping, optional
        A style or rcParams of matplotlib, which override those of the package.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If `show` is unknown, or needs a different number of axes.
    """
    if show is not None and show not in PANELS:
        raise ValueError(f"show = {show!r} is unknown; choose one of {', '.join(PANELS)}")
    size = figsize or ((9.6, 4.0) if show in (None, "both") else (4.8, 4.0))
    small = size[0] < NARROW and size[1] < LOW
    count = (1 if small else 2) if axes is None else np.size(np.asarray(axes, dtype=object))
    which = show or ("both" if count == 2 else "phase")
    if axes is not None and (which == "both") != (count == 2):
        raise ValueError(f"show = {which!r} needs {2 if which == 'both' else 1} axes, not {count}")
    arranged: dict[str, Any] = {"mosaic": "a"}
    if which == "both":
        arranged = {"mosaic": "a;b"} if size[0] < NARROW else {"mosaic": "ab", "width_ratios": (1.0, 1.5)}
    data = shown(orbit, points)
    with panels(axes, (1, 2), "an orbit is drawn on", size, style, arranged) as (figure, drawn):
        if heading and axes is None:
            text = title(orbit)
            figure.suptitle(text.split("\n")[0] if small else text, fontsize="medium", wrap=True)
        if which != "history":
            phase(drawn[0], data, orbit.real)
        if which != "phase":
            history(drawn[-1], data, orbit.real)
            handles = [handle for panel in drawn for handle in panel.get_legend_handles_labels()[0]]
            if isinstance(legend, str) and legend != "below":
                chosen: dict[str, Any] = {"handles": handles, "loc": legend, "fontsize": "small"}
                drawn[-1].legend(**chosen)
            elif legend:
                legend_below(drawn[-1], handles, axes is None)
    return figure


def title(orbit: Orbit) -> str:
    """Return a title of two lines: word, impacts, symmetry and stability; then the parameters."""
    size = np.abs(orbit.multipliers)
    if (
        size.size
        and np.abs(size - 1.0).min() <= SIMULATING.neutral
        and size.max() <= 1.0 + SIMULATING.neutral
    ):
        state = "marginal"  # at a fold, a symmetry breaking, ...
    else:
        state = "stable" if orbit.stable else "unstable"
    state += "" if orbit.real else ", virtual: no machine can follow it"
    parameters = quantities(orbit)
    # dimensionless numbers are shown by their symbols, physical quantities by their names
    plain = set(parameters) == set(orbit.parameters)
    values = ", ".join(
        f"{sign(name) if plain else name.replace('_', ' ')} = {value}"
        for name, value in parameters.items()
        if (name, value) != ("excitation", "1")
    )
    spelling = orbit.spelling
    if not len(orbit.word):
        return f"{'no event' if orbit.word.modes else 'stuck, the absorber rides with the cavity'}, {state}\n{values}"
    many = "impact" if orbit.impacts == 1 else "impacts"
    periods = "forcing period" if orbit.periods == 1 else "forcing periods"
    kind = "symmetric" if orbit.symmetric else "asymmetric"
    word = spelling if len(spelling) <= 60 else spelling[:40] + "..."
    return f"{word}, {orbit.impacts} {many} in {orbit.periods} {periods}, {kind}, {state}\n{values}"


def phase(axes: Axes, data: Shown, real: bool) -> None:
    """Draw y against x; jumps at events are dashed, virtual orbits dotted."""
    if data.limits is not None:
        ends, reach = data.limits
        axes.axhline(0.0, color="0.75", lw=0.7, zorder=0)
        for wall, end in zip(data.walls, ends):
            if (end - wall) * wall > 0.0:
                axes.axvspan(wall, end, color=WALL, lw=0.0)
        axes.set(xlim=ends, ylim=reach)
    for segment in np.unique(data.segment):
        here = np.flatnonzero(data.segment == segment)
        axes.plot(data.x[here], data.y[here], "-" if real else ":", color=LINE, lw=1.6, zorder=2)
    if not data.events and np.ptp(data.x) == np.ptp(data.y) == 0.0:
        axes.plot(data.x[:1], data.y[:1], "o", color=LINE, zorder=2)
    for i, event in enumerate(data.events):
        before = np.flatnonzero(data.segment == (i - 1) % len(data.events))[-1]
        jump = [data.x[before], event.x], [data.y[before], event.y]
        axes.plot(*jump, color=LINE, lw=0.8, ls=(0, (2, 2)))
    named: set[str] = set()
    for event in data.events:
        new = event.height is None and event.letter not in named
        named.add(event.letter)
        axes.plot(event.x, event.y, event.mark, label=event.name if new else None, **MARKER)
    axes.set(xlabel=data.names[0], ylabel=data.names[1])


def history(axes: Axes, data: Shown, real: bool) -> None:
    """Draw all curves over time, with walls and events."""
    for wall, edge in zip(data.walls, data.edges):  # position of the absorber at contact
        axes.plot(data.clock, edge, color=CAVITY, lw=1.0)
        axes.fill_between(data.clock, edge, edge - 0.25 * data.half * np.sign(wall), color=WALL, lw=0.0)
    for curve in data.curves.values():
        line = curve.dashes if real or curve.dashes != "-" else ":"
        axes.plot(data.clock, curve.values, line, color=curve.colour, lw=1.0 if line == "--" else 1.6, label=curve.label)  # fmt: skip
    named: set[str] = set()
    for event in data.events:
        if event.height is not None:
            label = event.name if event.letter not in named else None
            axes.plot(event.at, event.height, event.mark, label=label, **MARKER)
            named.add(event.letter)
            continue
        axes.axvline(event.at, color="#bdbdbd", lw=0.7, zorder=0)
        above = {"xycoords": ("data", "axes fraction"), "ha": "center", "va": "bottom", "fontsize": "small"}
        axes.annotate(event.letter, (event.at, 1.0), **above)
    axes.set(xlabel=data.time, ylabel=data.unit, xlim=(data.clock[0], data.clock[-1]))
    axes.margins(y=0.02)


def page(orbit: Orbit) -> str:
    """Return an HTML table of an orbit: motion, parameters, multipliers and least margin.

    Parameters
    ----------
    orbit : Orbit
    """
    multipliers = complex_figures(orbit.multipliers[:8])
    least = min(orbit.margins, key=lambda margin: margin.value, default=None)
    rows = [
        ("motion", title(orbit).split("\n")[0]),
        *quantities(orbit).items(),
        ("multipliers", multipliers or "-"),
        ("least margin", "-" if least is None else f"{figures(least.value)} ({least.kind})"),
    ]
    body = "".join(
        f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
        for name, text in rows
    )
    return f"<table><tbody>{body}</tbody></table>"
