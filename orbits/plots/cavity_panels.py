"""Panels of an absorber in its cavity: w' against w, and motions over forcing periods, with the walls and the events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.plots.shown import LINE, Shown, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from orbits.orbit import Orbit

MARKS = {"L": "o", "R": "s", "t": "^", "s": "D", "u": "v"}
WHAT = {"L": "impact left", "R": "impact right", "t": "turn", "s": "stick", "u": "slip"}
CAVITY, ABSORBER, WALL = "#6d6d6d", "#b5531c", "#d9d9d9"


def seen(orbit: Orbit, points: int) -> Shown:
    """What both panels show."""
    return shown(orbit, points)


def phase(axes: Axes, orbit: Orbit, seen: Shown) -> None:
    """The relative velocity against the relative position, left wall on the left."""
    w, rate = seen.motion["w"], seen.motion["w_rate"]
    reach = 1.15 * max(1e-3 * seen.half, float(np.abs(rate).max()))
    largest = float(np.abs(w).max())
    if not orbit.word.impact_free or largest > 0.5 * seen.half or largest == 0.0:
        ends = seen.left + 0.16 * seen.half, seen.right - 0.16 * seen.half
        for wall, end in zip((seen.left, seen.right), ends):
            axes.axvspan(wall, end, color=WALL, lw=0.0)
    else:
        ends = 1.5 * largest, -1.5 * largest
    axes.axhline(0.0, color="0.75", lw=0.7, zorder=0)
    line = "-" if orbit.real else ":"
    for segment in range(len(orbit.word)):
        here = seen.motion["segment"] == segment
        axes.plot(w[here], rate[here], line, color=LINE, lw=1.6, zorder=2)
    if not len(orbit.word):
        axes.plot([0.0], [0.0], "o", color=LINE, zorder=2)
    for i, letter in enumerate(orbit.word.events):
        if letter in "LR":  # the jump of the velocity
            jump = [seen.before[i], seen.after[i]]
            axes.plot([seen.w[i]] * 2, jump, color=LINE, lw=0.8, ls=(0, (2, 2)))
    _events(axes, orbit, seen.w, seen.after)
    unit = f" [{seen.length}]" if seen.length else ""
    axes.set(
        xlim=ends,  # w is positive at the left wall, which stands on the left
        ylim=(-reach, reach),
        xlabel=f"$w = q_1 - q_2${unit}, left wall at ${seen.left:+.6g}$",
        ylabel="relative velocity $w'$" + (f" [{seen.velocity}]" if seen.velocity else ""),
    )


def history(axes: Axes, orbit: Orbit, seen: Shown) -> None:
    """Cavity, absorber and walls over forcing periods."""
    turns = seen.motion["phase"] / (2.0 * np.pi)
    line = "-" if orbit.real else ":"
    cavity, absorber = seen.motion["cavity"], seen.motion["absorber"]
    for wall in (seen.left, seen.right):  # where the absorber touches it: q2 = q1 - w
        edge = cavity - wall
        axes.plot(turns, edge, color=CAVITY, lw=1.0)
        axes.fill_between(turns, edge, edge - 0.25 * seen.half * np.sign(wall), color=WALL, lw=0.0)
    axes.plot(turns, cavity, color=CAVITY, lw=1.0, ls="--", label="cavity, $q_1$")
    axes.plot(turns, absorber, line, color=ABSORBER, lw=1.6, label="absorber, $q_2$")
    _events(axes, orbit, orbit.events.phase / (2.0 * np.pi), seen.place, labelled=True)
    label = seen.positions if seen.length else r"positions in units of $b$"
    axes.set(xlabel=r"forcing periods $\Psi/2\pi$", ylabel=label, xlim=(turns[0], turns[-1]))
    axes.margins(y=0.02)


def _events(axes: Any, orbit: Orbit, x: np.ndarray, y: np.ndarray, labelled: bool = False) -> None:
    shown = set()
    for i, letter in enumerate(orbit.word.events):
        label = WHAT[letter] if labelled and letter not in shown else None
        shown.add(letter)
        axes.plot(
            x[i],
            y[i],
            MARKS[letter],
            color="white",
            mec="black",
            mew=1.0,
            ms=6,
            ls="none",
            zorder=4,
            label=label,
        )
