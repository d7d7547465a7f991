"""One orbit as plain numbers for a page that draws it: portrait, history, and what moves in its cavity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

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
    motion = orbit.sample(points)
    turns = motion["phase"] / (2.0 * np.pi)
    even = np.linspace(turns[0], turns[-1], points)
    cavity, absorber = (np.interp(even, turns, motion[name]) for name in ("cavity", "absorber"))
    table = orbit.events
    return {
        "portrait": {
            "x": motion["w"],
            "y": motion["w_rate"],
            "names": ["relative position w (left wall at +1)", "relative velocity w'"],
            "walls": [1.0, -1.0],
            "reversed": True,
        },
        "history": {
            "x": turns,
            "name": "forcing periods",
            "unit": "positions in units of b",
            "curves": {"cavity": motion["cavity"], "absorber": motion["absorber"]},
            "walls": [motion["cavity"] + 1.0, motion["cavity"] - 1.0],
        },
        "animation": {
            "box": cavity,
            "body": absorber,
            "half_width": 1.0,
            "left": 1.0,
            "periods": orbit.periods,
        },
        "events": [
            {
                "event": letter,
                "at": float(table.phase[i] / (2.0 * np.pi)),
                "x": float(table.w[i]),
                "y": float(table.rate_post[i]),
            }
            for i, letter in enumerate(orbit.word.events)
        ],
    }
