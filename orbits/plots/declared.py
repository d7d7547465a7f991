"""Phase portrait and time history of an orbit of a declared machine, with its events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.figures import new_figure, styled
from contvines.shared.near_arguments import hinting
from orbits.plots.portrait import LOW, NARROW, ORBIT, title
from orbits.plots.track import track

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.orbit import Orbit

MARKS = "osD^v<>Ph*Xd"
COLOURS = (ORBIT, "#b5531c", "#3f7f4c", "#7a4b8f", "#8a6d1f", "#4a4a4a")


@hinting
def portrait(
    orbit: Orbit,
    points: int = 1200,
    *,
    axes: Axes | Sequence[Axes] | None = None,
    heading: bool = True,
    legend: bool | str = True,
    figsize: tuple[float, float] | None = None,
    style: str | Mapping[str, Any] | None = None,
) -> Figure:
    """Draw the orbit: the first two states against one another on the left, all states over time on the right.

    Parameters
    ----------
    orbit : Orbit
    points : int
        Samples over the period.
    axes : Axes or two of them, optional
        Drawn on: one has the phase portrait, two have both. Without, a new figure.
    heading : bool
        Write what the orbit is above a new figure.
    legend : bool or str
        Whether events and states are named, or where: a place that matplotlib knows.
    figsize : (float, float), optional
        Inches, of a new figure; where it is narrow the two stand below one another, where it is small the first stands alone.
    style : str or mapping, optional
        A style or rcParams of matplotlib's that come before the house's.
    """
    names = list(orbit.model.states)
    motion = orbit.sample(points)
    with styled(style):
        if axes is None:
            size = figsize or (9.6, 4.0)
            small = size[0] < NARROW and size[1] < LOW
            figure: Any = new_figure(size)
            if small:
                drawn = [figure.add_subplot()]
            elif size[0] < NARROW:
                drawn = list(figure.subplots(2, 1))
            else:
                drawn = list(figure.subplots(1, 2, width_ratios=(1.0, 1.5)))
            if heading:
                text = title(orbit)  # type: ignore[arg-type]
                figure.suptitle(text.split("\n")[0] if small else text, fontsize="medium", wrap=True)
        else:
            drawn = list(axes) if isinstance(axes, Sequence | np.ndarray) else [axes]
            figure = drawn[0].get_figure(root=True)
        _phase(drawn[0], orbit, motion, names[0], names[1] if len(names) > 1 else names[0])
        if len(drawn) > 1:
            _history(drawn[-1], orbit, motion)
        for panel in drawn:
            if legend is not False and panel.get_legend_handles_labels()[0]:
                look: dict[str, Any] = {"loc": legend if isinstance(legend, str) else "best"}
                panel.legend(fontsize="small", ncols=1 if panel is drawn[0] else 2, **look)
    return figure


def scene(orbit: Orbit, points: int = 120) -> dict[str, Any]:
    """Curves of one period as plain numbers, as `orbits.plots.scene.scene` has them; the animation is that of `track`.

    Parameters
    ----------
    orbit : Orbit
    points : int
        About how many samples.
    """
    motion, names = orbit.sample(points), list(orbit.model.states)
    x, y = names[0], names[1] if len(names) > 1 else names[0]
    clock = _clock(orbit, motion)
    starts = _starts(orbit, motion, clock)
    columns = [1 + names.index(name) for name in (x, y)]
    return {
        "portrait": {"x": motion[x], "y": motion[y], "names": [x, y], "walls": [], "reversed": False},
        "history": {
            "x": clock,
            "name": _time(orbit),
            "unit": "states",
            "curves": {name: motion[name] for name in names},
            "walls": [],
        },
        "animation": track(orbit, motion),
        "events": [
            {"event": letter, "at": float(at), "x": float(node[columns[0]]), "y": float(node[columns[1]])}
            for letter, at, node in zip(orbit.word.events, starts, orbit.nodes)
        ],
    }


def _time(orbit: Orbit) -> str:
    return "forcing periods" if orbit.model.forced else "time"


def _clock(orbit: Orbit, motion: dict[str, np.ndarray]) -> np.ndarray:
    return motion["phase"] / (2.0 * np.pi) if orbit.model.forced else motion["time"]


def _starts(orbit: Orbit, motion: dict[str, np.ndarray], clock: np.ndarray) -> list[Any]:
    """When each event happens."""
    return [clock[np.searchsorted(motion["segment"], i)] for i in range(len(orbit.word))]


def _phase(axes: Axes, orbit: Orbit, motion: dict[str, np.ndarray], x: str, y: str) -> None:
    axes.plot(motion[x], motion[y], color=ORBIT)
    letters = dict.fromkeys(orbit.word.events)
    columns = [1 + orbit.model.states.index(name) for name in (x, y)]
    for mark, letter in zip(MARKS, letters):
        places = [i for i, event in enumerate(orbit.word.events) if event == letter]
        here = orbit.nodes[places][:, columns]
        axes.plot(here[:, 0], here[:, 1], mark, color=ORBIT, mfc="white", ms=5, label=f"after {letter}")
    axes.set(xlabel=x, ylabel=y)


def _history(axes: Axes, orbit: Orbit, motion: dict[str, np.ndarray]) -> None:
    clock = _clock(orbit, motion)
    for name, colour in zip(orbit.model.states, COLOURS * 3):
        axes.plot(clock, motion[name], color=colour, label=name)
    for where, letter in zip(_starts(orbit, motion, clock), orbit.word.events):
        axes.axvline(where, color="#bdbdbd", lw=0.7, zorder=0)
        axes.annotate(
            letter,
            (where, 1.0),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize="small",
        )
    axes.set(xlabel=_time(orbit), ylabel="states")
