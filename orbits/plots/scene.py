"""One orbit as plain numbers for a page that draws it: portrait, history, and what moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from orbits.plots.shown import shown

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
        ``portrait`` (x, y, their names, walls, whether x grows to the left), ``history`` (turns of the forcing or time, named
        curves, walls), ``animation`` (positions of the cavity and of the absorber in it, evenly spaced in time; of a declared machine see
        `orbits.plots.track`), ``events``.
    """
    seen = shown(orbit, points)
    return {
        "portrait": {
            "x": seen.x,
            "y": seen.y,
            "names": list(seen.names),
            "walls": list(seen.walls),
            "reversed": bool(seen.walls),
        },
        "history": {
            "x": seen.clock,
            "name": seen.time,
            "unit": seen.unit,
            "curves": {name: curve.values for name, curve in seen.curves.items()},
            "walls": list(seen.edges),
        },
        "animation": seen.animation,
        "events": [{"event": e.letter, "at": e.at, "x": e.x, "y": e.y} for e in seen.events],
    }
