"""One orbit as plain numbers for a page that draws it: portrait, history, and what moves in its cavity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.plots.shown import shown
from orbits.plots.state_panels import clock_of, first_two, starts_of, time_name
from orbits.plots.track import track

if TYPE_CHECKING:
    from orbits.orbit import Orbit


def scene(orbit: Orbit, points: int = 120) -> dict[str, Any]:
    """Curves of one period, ready for JSON.

    Parameters
    ----------
    orbit : Orbit
    points : int
        About how many samples.

    Returns
    -------
    dict
        ``portrait`` (x, y, their names, walls, the side on which x grows), ``history`` (turns of the forcing, named
        curves, walls), ``animation`` (position of the cavity and of the absorber in it, evenly spaced in time), ``events``.
    """
    if orbit.model.flow == "page":
        return _of_states(orbit, points)
    seen = shown(orbit, points)
    motion = seen.motion
    turns = motion["phase"] / (2.0 * np.pi)
    even = np.linspace(turns[0], turns[-1], points)
    cavity, absorber = (np.interp(even, turns, motion[name]) for name in ("cavity", "absorber"))
    walls = [seen.left, seen.right]
    return {
        "portrait": {
            "x": motion["w"],
            "y": motion["w_rate"],
            "names": list(seen.names),
            "walls": walls,
            "reversed": True,
        },
        "history": {
            "x": turns,
            "name": "forcing periods",
            "unit": seen.positions,
            "curves": {"cavity": motion["cavity"], "absorber": motion["absorber"]},
            "walls": [motion["cavity"] - wall for wall in walls],
        },
        "animation": {
            "box": cavity,
            "body": absorber,
            "walls": walls,
            "left": 1.0,
            "periods": orbit.periods,
        },
        "events": [
            {"event": letter, "at": float(phase / (2.0 * np.pi)), "x": float(x), "y": float(y)}
            for letter, phase, x, y in zip(orbit.word.events, orbit.events.phase, seen.w, seen.after)
        ],
    }


def _of_states(orbit: Orbit, points: int) -> dict[str, Any]:
    """The same of a machine on a page, whose animation is that of `orbits.plots.track`."""
    motion, names = orbit.sample(points), list(orbit.model.states)
    x, y = first_two(orbit)
    clock = clock_of(orbit, motion)
    starts = starts_of(orbit, motion, clock)
    columns = [1 + names.index(name) for name in (x, y)]
    return {
        "portrait": {"x": motion[x], "y": motion[y], "names": [x, y], "walls": [], "reversed": False},
        "history": {
            "x": clock,
            "name": time_name(orbit),
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
