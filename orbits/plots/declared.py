"""Phase portrait and time history of an orbit of a declared machine, with its events."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.plots.portrait import ORBIT, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.machines.declared.orbit import DeclaredOrbit

MARKS = "osD^v<>Ph*Xd"
COLOURS = (ORBIT, "#b5531c", "#3f7f4c", "#7a4b8f", "#8a6d1f", "#4a4a4a")


def portrait(orbit: DeclaredOrbit, points: int = 1200) -> Figure:
    """Draw the orbit: the first two states against one another on the left, all states over time on the right.

    Parameters
    ----------
    orbit : DeclaredOrbit
    points : int
        Samples over the period.
    """
    import matplotlib.pyplot as plt

    names = list(orbit.machine.states)
    with plt.style.context(str(files("orbits.plots") / "house.mplstyle")):
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(9.6, 4.0), width_ratios=(1.0, 1.5), layout="constrained"
        )
        motion = orbit.sample(points)
        second = names[1] if len(names) > 1 else names[0]
        _phase(left, orbit, motion, names[0], second)
        _history(right, orbit, motion)
        figure.suptitle(title(orbit), fontsize="medium")  # type: ignore[arg-type]
    return figure


def _phase(axes: Axes, orbit: DeclaredOrbit, motion: dict[str, np.ndarray], x: str, y: str) -> None:
    axes.plot(motion[x], motion[y], color=ORBIT)
    letters = dict.fromkeys(orbit.word.events)
    columns = [1 + orbit.machine.states.index(name) for name in (x, y)]
    for mark, letter in zip(MARKS, letters):
        places = [i for i, event in enumerate(orbit.word.events) if event == letter]
        here = orbit.nodes[places][:, columns]
        axes.plot(here[:, 0], here[:, 1], mark, color=ORBIT, mfc="white", ms=5, label=f"after {letter}")
    axes.set(xlabel=x, ylabel=y)
    if letters:
        axes.legend(fontsize="small", loc="best")


def _history(axes: Axes, orbit: DeclaredOrbit, motion: dict[str, np.ndarray]) -> None:
    forced = orbit.machine.forced
    clock = motion["phase"] / (2.0 * np.pi) if forced else motion["time"]
    for name, colour in zip(orbit.machine.states, COLOURS * 3):
        axes.plot(clock, motion[name], color=colour, label=name)
    starts: list[Any] = [clock[np.searchsorted(motion["segment"], i)] for i in range(len(orbit.word))]
    for where, letter in zip(starts, orbit.word.events):
        axes.axvline(where, color="#bdbdbd", lw=0.7, zorder=0)
        axes.annotate(
            letter,
            (where, 1.0),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize="small",
        )
    axes.set(xlabel="forcing periods" if forced else "time", ylabel="states")
    axes.legend(fontsize="small", loc="best", ncols=2)
