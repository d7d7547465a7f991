"""What pictures of an orbit show, in the units of its machine: a portrait, a history, walls and events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from orbits.contacts.letters import NAMES
from orbits.machines.base import Model
from orbits.plots.track import track

if TYPE_CHECKING:
    from collections.abc import Sequence

    from orbits.orbit import Orbit

LINE, CAVITY, ABSORBER = "#0b3c6f", "#6d6d6d", "#b5531c"
COLOURS = (LINE, ABSORBER, "#3f7f4c", "#7a4b8f", "#8a6d1f", "#4a4a4a")
MARKS = "os^Dv<>Ph*Xd"


class Curve(NamedTuple):
    """A curve of the history."""

    label: str
    values: np.ndarray
    colour: str
    dashes: str = "-"


class Happening(NamedTuple):
    """An event: its letter and mark, what it is called, when it happens, where the portrait and the history (None: nowhere) have it."""

    letter: str
    mark: str
    called: str
    at: float
    x: float
    y: float
    height: float | None


@dataclass(frozen=True)
class Shown:
    """One period of an orbit.

    Attributes
    ----------
    x, y, clock : float arrays (m,)
        Of the portrait, and forcing periods or time; events have two samples, before and after.
    segment : int array (m,)
        Index of the event before.
    names : (str, str)
        Of x and y, with their units.
    time, unit : str
        What the history's axes are.
    curves : dict
        By name.
    walls : tuple of float
        Where x ends; `edges` are the places of the walls in the history, `half` is half of what lies between them.
    limits : ((float, float), (float, float)) or None
        Of the portrait; the first ones may fall.
    events : list of Happening
    animation : dict or None
        What moves; see `orbits.plots.scene.scene`.
    """

    x: np.ndarray
    y: np.ndarray
    clock: np.ndarray
    segment: np.ndarray
    names: tuple[str, str]
    time: str
    unit: str
    curves: dict[str, Curve]
    events: list[Happening]
    animation: dict[str, Any] | None
    walls: tuple[float, ...] = ()
    edges: tuple[np.ndarray, ...] = ()
    half: float = 1.0
    limits: tuple[tuple[float, float], tuple[float, float]] | None = None


def shown(orbit: Orbit, points: int) -> Shown:
    """An orbit as pictures show it, with about so many samples."""
    model = orbit.model
    return _of_cavity(orbit, model, points) if isinstance(model, Model) else _of_states(orbit, points)


def _of_cavity(orbit: Orbit, model: Model, points: int) -> Shown:
    """The absorber in its cavity: its relative position and velocity, left wall on the left; both bodies over forcing periods."""
    params, table, motion = orbit.params, orbit.events, orbit.sample(points)
    known = model.gauges(("w", "w_rate"), params)
    (long, length), (fast, velocity) = (known.get(name, (1.0, "")) for name in ("w", "w_rate"))
    w, rate = motion["w"] * long, motion["w_rate"] * fast
    cavity, absorber = motion["cavity"] * long, motion["absorber"] * long
    left, right = (long * float(wall) for wall in model.walls(params))
    half, largest = 0.5 * (left - right), float(np.abs(w).max())
    near = orbit.word.impact_free and 0.0 < largest <= 0.5 * half
    ends = (1.5 * largest, -1.5 * largest) if near else (left + 0.16 * half, right - 0.16 * half)
    reach = 1.15 * max(0.001 * half, float(np.abs(rate).max()))
    turns = motion["phase"] / (2.0 * np.pi)
    even = np.linspace(turns[0], turns[-1], points)
    box, body = (np.interp(even, turns, place) for place in (cavity, absorber))
    unit, per_time = (f" [{name}]" if name else "" for name in (length, velocity))
    _, place = model.bodies(table.w, table.v, params)
    events = _events(
        orbit, table.phase / (2.0 * np.pi), table.w * long, table.rate_post * fast, np.asarray(place) * long
    )
    return Shown(
        w, rate, turns, motion["segment"],
        (f"relative position w{unit} (left wall at {left:+.6g})", f"relative velocity w'{per_time}"),
        "forcing periods", f"positions [{length}]" if length else "positions in units of b",
        {"cavity": Curve("cavity, $q_1$", cavity, CAVITY, "--"), "absorber": Curve("absorber, $q_2$", absorber, ABSORBER)},
        events,
        {"box": box, "body": body, "walls": [left, right], "left": 1.0, "periods": orbit.periods},
        (left, right), (cavity - left, cavity - right), half, (ends, (-reach, reach)),
    )  # fmt: skip


def _of_states(orbit: Orbit, points: int) -> Shown:
    """A declared machine: its first two states against one another, and all states over time."""
    motion, names = orbit.sample(points), list(orbit.model.node_names[1:])
    x, y = names[0], names[1] if len(names) > 1 else names[0]
    clock = motion["phase"] / (2.0 * np.pi) if orbit.forced else motion["time"]
    first = [np.searchsorted(motion["segment"], i) for i in range(len(orbit.word))]
    nodes = orbit.nodes[: len(orbit.word)]
    events = _events(
        orbit, clock[first], nodes[:, 1 + names.index(x)], nodes[:, 1 + names.index(y)], [None] * len(first)
    )
    curves = {name: Curve(name, motion[name], colour) for name, colour in zip(names, COLOURS * 9)}
    time = "forcing periods" if orbit.forced else "time"
    return Shown(
        motion[x], motion[y], clock, motion["segment"], (x, y), time, "states", curves, events,
        track(orbit, motion),
    )  # fmt: skip


def _events(
    orbit: Orbit, at: np.ndarray, x: np.ndarray, y: np.ndarray, heights: Sequence[Any] | np.ndarray
) -> list[Happening]:
    alphabet, sides = orbit.word.alphabet, {"L": " left", "R": " right"}
    marks = dict(zip(alphabet.letters, MARKS * 9))
    called = {
        text: f"{NAMES[letter.kind]}{sides.get(text, '')}" if alphabet.alone is not None else f"after {text}"
        for text, letter in alphabet.letters.items()
    }
    return [
        Happening(text, marks[text], called[text], float(t), float(a), float(b), h if h is None else float(h))
        for text, t, a, b, h in zip(orbit.word.events, at, x, y, heights)
    ]


def quantities(orbit: Orbit) -> dict[str, str]:
    """Parameters of an orbit by name as text: quantities with their units, or the machine's plain numbers.

    Parameters
    ----------
    orbit : Orbit
    """
    about = orbit.model.described(orbit.params)
    units = about.get("units", {})
    return {
        name: f"{value:.6g} {units.get(name, '')}".rstrip() for name, value in about["parameters"].items()
    }
