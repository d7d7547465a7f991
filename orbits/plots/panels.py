"""The two panels of an orbit: its portrait, and its history."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from orbits.plots.shown import CAVITY, LINE, Shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WALL = "#d9d9d9"
MARKER = {"color": "white", "mec": "black", "mew": 1.0, "ms": 6, "ls": "none", "zorder": 4}


def phase(axes: Axes, seen: Shown, real: bool) -> None:
    """y against x; what jumps at an event is dashed, a motion that no machine follows dotted."""
    if seen.limits is not None:
        ends, reach = seen.limits
        axes.axhline(0.0, color="0.75", lw=0.7, zorder=0)
        for wall, end in zip(seen.walls, ends):
            if (end - wall) * wall > 0.0:
                axes.axvspan(wall, end, color=WALL, lw=0.0)
        axes.set(xlim=ends, ylim=reach)
    for segment in np.unique(seen.segment):
        here = np.flatnonzero(seen.segment == segment)
        axes.plot(seen.x[here], seen.y[here], "-" if real else ":", color=LINE, lw=1.6, zorder=2)
    if not seen.events and np.ptp(seen.x) == np.ptp(seen.y) == 0.0:
        axes.plot(seen.x[:1], seen.y[:1], "o", color=LINE, zorder=2)
    for i, event in enumerate(seen.events):
        before = np.flatnonzero(seen.segment == (i - 1) % len(seen.events))[-1]
        jump = [seen.x[before], event.x], [seen.y[before], event.y]
        axes.plot(*jump, color=LINE, lw=0.8, ls=(0, (2, 2)))
    named: set[str] = set()
    for event in seen.events:
        new = event.height is None and event.letter not in named
        named.add(event.letter)
        axes.plot(event.x, event.y, event.mark, label=event.called if new else None, **MARKER)
    axes.set(xlabel=seen.names[0], ylabel=seen.names[1])


def history(axes: Axes, seen: Shown, real: bool) -> None:
    """All curves over time, the walls beside them, and the events."""
    for wall, edge in zip(seen.walls, seen.edges):  # where a body touches it
        axes.plot(seen.clock, edge, color=CAVITY, lw=1.0)
        axes.fill_between(seen.clock, edge, edge - 0.25 * seen.half * np.sign(wall), color=WALL, lw=0.0)
    for curve in seen.curves.values():
        line = curve.dashes if real or curve.dashes != "-" else ":"
        axes.plot(seen.clock, curve.values, line, color=curve.colour, lw=1.0 if line == "--" else 1.6, label=curve.label)  # fmt: skip
    named: set[str] = set()
    for event in seen.events:
        if event.height is not None:
            label = event.called if event.letter not in named else None
            axes.plot(event.at, event.height, event.mark, label=label, **MARKER)
            named.add(event.letter)
            continue
        axes.axvline(event.at, color="#bdbdbd", lw=0.7, zorder=0)
        above = {"xycoords": ("data", "axes fraction"), "ha": "center", "va": "bottom", "fontsize": "small"}
        axes.annotate(event.letter, (event.at, 1.0), **above)
    axes.set(xlabel=seen.time, ylabel=seen.unit, xlim=(seen.clock[0], seen.clock[-1]))
    axes.margins(y=0.02)
