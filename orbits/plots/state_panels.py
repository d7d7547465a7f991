"""Panels of a machine on a page: the first two states against one another, and all states over time, with the events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.plots.shown import LINE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from orbits.orbit import Orbit

MARKS = "osD^v<>Ph*Xd"
COLOURS = (LINE, "#b5531c", "#3f7f4c", "#7a4b8f", "#8a6d1f", "#4a4a4a")


def seen(orbit: Orbit, points: int) -> dict[str, np.ndarray]:
    """What both panels show."""
    return orbit.sample(points)


def first_two(orbit: Orbit) -> tuple[str, str]:
    """The states of the phase portrait."""
    names = orbit.model.states
    return names[0], names[1] if len(names) > 1 else names[0]


def time_name(orbit: Orbit) -> str:
    return "forcing periods" if orbit.model.forced else "time"


def clock_of(orbit: Orbit, motion: dict[str, np.ndarray]) -> np.ndarray:
    return motion["phase"] / (2.0 * np.pi) if orbit.model.forced else motion["time"]


def starts_of(orbit: Orbit, motion: dict[str, np.ndarray], clock: np.ndarray) -> list[Any]:
    """When each event happens."""
    return [clock[np.searchsorted(motion["segment"], i)] for i in range(len(orbit.word))]


def phase(axes: Axes, orbit: Orbit, motion: dict[str, np.ndarray]) -> None:
    """The first two states against one another."""
    x, y = first_two(orbit)
    axes.plot(motion[x], motion[y], color=LINE)
    letters = dict.fromkeys(orbit.word.events)
    columns = [1 + orbit.model.states.index(name) for name in (x, y)]
    for mark, letter in zip(MARKS, letters):
        places = [i for i, event in enumerate(orbit.word.events) if event == letter]
        here = orbit.nodes[places][:, columns]
        axes.plot(here[:, 0], here[:, 1], mark, color=LINE, mfc="white", ms=5, label=f"after {letter}")
    axes.set(xlabel=x, ylabel=y)


def history(axes: Axes, orbit: Orbit, motion: dict[str, np.ndarray]) -> None:
    clock = clock_of(orbit, motion)
    for name, colour in zip(orbit.model.states, COLOURS * 3):
        axes.plot(clock, motion[name], color=colour, label=name)
    for where, letter in zip(starts_of(orbit, motion, clock), orbit.word.events):
        axes.axvline(where, color="#bdbdbd", lw=0.7, zorder=0)
        axes.annotate(
            letter,
            (where, 1.0),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize="small",
        )
    axes.set(xlabel=time_name(orbit), ylabel="states")
