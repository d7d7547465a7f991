"""Phase portrait and time history of one orbit, with the cavity's walls and the events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.figures import new_figure, styled
from contvines.shared.near_arguments import hinting
from orbits.plots.shown import Shown, quantities, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.orbit import Orbit

MARKS = {"L": "o", "R": "s", "t": "^", "s": "D", "u": "v"}
WHAT = {"L": "impact left", "R": "impact right", "t": "turn", "s": "stick", "u": "slip"}
ORBIT, CAVITY, ABSORBER, WALL = "#0b3c6f", "#6d6d6d", "#b5531c", "#d9d9d9"
# parameters as in the diagrams
SYMBOLS = {
    "amplitude": "$C$",
    "frequency": r"$\Omega$",
    "restitution": "$r$",
    "friction": r"$\mu$",
    "gravity": r"$\tilde g$",
    "mass_ratio": r"$\varepsilon$",
    "forcing": "$G$",
    "damping": r"$\lambda$",
}


PANELS = ("both", "phase", "history")
NARROW, LOW = 6.0, 3.4  # inches: below, panels stand under one another, or the phase portrait stands alone


@hinting
def portrait(
    orbit: Orbit,
    points: int = 1200,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    show: str | None = None,
    heading: bool = True,
    legend: bool | str = True,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> Figure:
    """Draw the orbit: w' against w, left wall on the left, and motions over forcing periods.

    Parameters
    ----------
    orbit : Orbit
    points : int
        Samples over the period.
    axes : Axes or two of them, optional
        Drawn on: one has the phase portrait (or the history, if `show` says so), two have both. Without, a new figure.
    show : {"both", "phase", "history"}, optional
        By default both, or the phase portrait alone where a figure is small.
    heading : bool
        Write what the orbit is above a new figure.
    legend : bool or str
        Whether the history is explained, or where: "below", or a place that matplotlib knows.
    figsize : (float, float), optional
        Inches, of a new figure.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the house's.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If `show` is none of its values, or does not fit the axes given.
    """
    if show is not None and show not in PANELS:
        raise ValueError(f"show = {show!r} is unknown; choose one of {', '.join(PANELS)}")
    seen = shown(orbit, points)
    with styled(style):
        if axes is None:
            size = figsize or ((9.6, 4.0) if show in (None, "both") else (4.8, 4.0))
            small = size[0] < NARROW and size[1] < LOW
            panels = show or ("phase" if small else "both")
            figure = new_figure(size)
            if panels != "both":
                drawn = [figure.add_subplot()]
            elif size[0] < NARROW:
                drawn = list(figure.subplots(2, 1))
            else:
                drawn = list(figure.subplots(1, 2, width_ratios=(1.0, 1.5)))
            if heading:
                text = title(orbit)
                figure.suptitle(text.split("\n")[0] if small else text, fontsize="medium", wrap=True)
        else:
            drawn = list(axes) if isinstance(axes, Sequence | np.ndarray) else [axes]
            panels = show or ("both" if len(drawn) == 2 else "phase")
            if (panels == "both") != (len(drawn) == 2):
                raise ValueError(
                    f"show = {panels!r} needs {2 if panels == 'both' else 1} axes, not {len(drawn)}"
                )
            figure: Any = drawn[0].get_figure(root=True)
        if panels != "history":
            _phase(drawn[0], orbit, seen)
        if panels != "phase":
            _history(drawn[-1], orbit, seen)
            key(figure, drawn[-1], axes is None, legend)
    return figure


def title(orbit: Orbit) -> str:
    """What the orbit is, in two lines: word, impacts, symmetry and stability; then its parameters."""
    size = np.abs(orbit.multipliers)
    if size.size and np.abs(size - 1.0).min() <= 1e-6 and size.max() <= 1.0 + 1e-6:
        state = "marginal"  # at a fold, a symmetry breaking, ...
    else:
        state = "stable" if orbit.stable else "unstable"
    state += "" if orbit.real else ", virtual: no machine can follow it"
    parameters = quantities(orbit)
    plain = set(parameters) == set(
        orbit.parameters
    )  # numbers have symbols, quantities are called by their names
    here = ", ".join(
        f"{SYMBOLS.get(name, name) if plain else name.replace('_', ' ')} = {value}"
        for name, value in parameters.items()
        if (name, value) != ("excitation", "1")
    )
    told = getattr(
        orbit, "spelling", None
    )  # machines on a page have none: any of their words may be read as it stands
    if not len(orbit.word):
        return (
            f"{'no event' if told is None else 'stuck, the absorber rides with the cavity'}, {state}\n{here}"
        )
    many = "impact" if orbit.impacts == 1 else "impacts"
    periods = "forcing period" if orbit.periods == 1 else "forcing periods"
    kind = "symmetric" if orbit.symmetric else "asymmetric"
    word = str(orbit.word) if told is None else told
    word = word if len(word) <= 60 else word[:40] + "..."
    return f"{word}, {orbit.impacts} {many} in {orbit.periods} {periods}, {kind}, {state}\n{here}"


def _phase(axes: Axes, orbit: Orbit, seen: Shown) -> None:
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
        axes.plot(w[here], rate[here], line, color=ORBIT, lw=1.6, zorder=2)
    if not len(orbit.word):
        axes.plot([0.0], [0.0], "o", color=ORBIT, zorder=2)
    for i, letter in enumerate(orbit.word.events):
        if letter in "LR":  # the jump of the velocity
            jump = [seen.before[i], seen.after[i]]
            axes.plot([seen.w[i]] * 2, jump, color=ORBIT, lw=0.8, ls=(0, (2, 2)))
    _events(axes, orbit, seen.w, seen.after)
    unit = f" [{seen.length}]" if seen.length else ""
    axes.set(
        xlim=ends,  # w is positive at the left wall, which stands on the left
        ylim=(-reach, reach),
        xlabel=f"$w = q_1 - q_2${unit}, left wall at ${seen.left:+.6g}$",
        ylabel="relative velocity $w'$" + (f" [{seen.velocity}]" if seen.velocity else ""),
    )


def _history(axes: Axes, orbit: Orbit, seen: Shown) -> None:
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


def key(figure: Any, axes: Axes, own: bool, legend: bool | str) -> None:
    """A legend under everything in a figure of ours, which makes room for it; under the axes in others; or where it is wanted."""
    if legend is False:
        return
    if isinstance(legend, str) and legend != "below":
        chosen: dict[str, Any] = {"loc": legend, "fontsize": "small"}
        axes.legend(**chosen)
        return
    handles, labels = axes.get_legend_handles_labels()
    if own:
        columns = len(labels) if figure.get_size_inches()[0] >= 1.35 * len(labels) else 2
        look = {"ncols": columns, "frameon": False, "fontsize": "small"}
        figure.legend(handles, labels, loc="outside lower center", **look)
        return
    figure.draw_without_rendering()
    box = axes.xaxis.get_tightbbox()
    low = axes.bbox.y0 if box is None else min(box.y0, axes.bbox.y0)
    gap = (low - axes.bbox.y0 - 4.0 * figure.dpi / 72.0) / axes.bbox.height
    look = {"ncols": 2, "frameon": False, "fontsize": "small", "borderaxespad": 0.0}
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, gap), **look)


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
