"""Why no branch goes on at a border, where the reason is known."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.cycles.solution import Solution
from orbits.protocol import CycleProblem

SLOW = 1e-3  # of the machine's own speed, or length: impacts slower than this, turns closer to a wall
UNRESOLVED = 1e-5  # the way after an impact that ends this slow, its square, is lost in that of the margins
VANISHING = 1e-9  # margins smaller than this are those of the border itself
ONE_WAY = 1e-9  # relative difference of the frictions, slope included, of the two directions

CREEPS = (
    "friction gives way in one direction only: the absorber creeps along the cavity until a wall stops it"
)
PILING = "impacts pile up at a wall: of those before it the slowest has {speed:.1e} of the machine's own speed, and a further one cannot be told from rest"
TOUCHING = "turns pile up at a wall: of those before it the nearest keeps {gap:.1e} of the machine's own length, and a further one cannot be told from contact"
FADING = "a stick that lasts {length:.1e} of the machine's own time, with {reserve:.1e} of its friction in reserve, is about to vanish as well: motions between the two borders cannot be resolved"
UNKNOWN = (
    "no motion that goes on from this one was found, neither by the rules of the contacts nor by simulation"
)


def dead_end(problem: CycleProblem, point: Any) -> str:
    """A sentence that says why no motion was found on the other side of a border."""
    u, p = np.asarray(point.u, dtype=float), float(point.value)
    orbit = problem.orbit(u, p)
    if not len(problem.word):
        return CREEPS if _gives_way_one_way(orbit) else UNKNOWN
    margins = orbit.relative_margins
    speeds = [m.value for m in margins if m.kind == "approach" and VANISHING < m.value < SLOW]
    turns = [k for k, letter in enumerate(orbit.word.events) if letter == "t"]
    gaps = [
        m.value for m in margins if m.kind == "wall" and m.segment in turns and VANISHING < m.value < SLOW
    ]
    if speeds:
        return PILING.format(speed=min(speeds))
    if gaps:
        return TOUCHING.format(gap=min(gaps))
    fading = _fading(orbit)
    return FADING.format(length=fading[0], reserve=fading[1]) if fading else UNKNOWN


def _fading(orbit: Solution) -> tuple[float, float] | None:
    """Duration of a stick, and the reserve of friction at its start, where both are about to vanish."""
    seen = {(m.kind, m.segment): m.value for m in orbit.relative_margins}
    for place, letter in enumerate(orbit.word.events):
        pair = seen.get(("duration", place), np.inf), seen.get(("stick", place), np.inf)
        if letter == "s" and min(pair) > VANISHING and max(pair) < SLOW:
            return pair
    return None


def piled_up(orbit: Solution, approaches: np.ndarray | None = None) -> bool:
    """Whether a border orbit has an impact that is too slow, once the wall has sent it back, to see what the next ones do.

    `approaches` are the orbit's own, where they are known.
    """
    speeds = (orbit.approaches if approaches is None else approaches).tolist()
    back, codes = orbit.model.restitutions(orbit.params), orbit.word.codes
    hits = codes[codes < 2].tolist()
    return any(speed > VANISHING and back[hit] * speed < UNRESOLVED for speed, hit in zip(speeds, hits))


def _gives_way_one_way(orbit: Solution) -> bool:
    """Whether friction and slope hold the absorber better one way than the other."""
    reserves = getattr(orbit.model.rest, "reserves", None)
    if reserves is None:
        return False
    left, right = reserves(orbit.params)
    return abs(left - right) > ONE_WAY * orbit.model.friction_acceleration(orbit.params)
