"""Data of an orbit's pictures, in the units of its machine: phase portrait, history, walls, events, and moving bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from orbits.contacts import NAMES
from orbits.contacts.wall import Wall
from orbits.machines.base import Model
from orbits.machines.page.page import Named, NoPhase, States

if TYPE_CHECKING:
    from collections.abc import Sequence

    from orbits.orbit import Orbit


LINE, CAVITY, ABSORBER = "#0b3c6f", "#6d6d6d", "#b5531c"
COLOURS = (LINE, ABSORBER, "#3f7f4c", "#7a4b8f", "#8a6d1f", "#4a4a4a")
MARKS = "os^Dv<>Ph*Xd"
ALIKE = 0.02  # largest deviation of a state from the rate of another one, relative to the latter's changes


class Curve(NamedTuple):
    """A curve of the history."""

    label: str
    values: np.ndarray
    colour: str
    dashes: str = "-"


class Happening(NamedTuple):
    """An event: letter, marker, name in the legend, time, position in the portrait, and height in the history (None: no marker there)."""

    letter: str
    mark: str
    name: str
    at: float
    x: float
    y: float
    height: float | None


@dataclass(frozen=True)
class Shown:
    """Data of one period of an orbit.

    Attributes
    ----------
    x, y, clock : float arrays (m,)
        Coordinates of the portrait, and time (or forcing periods); each event has two samples, before and after it.
    segment : int array (m,)
        Index of the event before each sample.
    names : (str, str)
        Labels of x and y, with units.
    time, unit : str
        Labels of the axes of the history.
    curves : dict
        Name -> curve of the history.
    events : list of Happening
    animation : dict or None
        Moving bodies and walls; see `orbits.plots.shown.scene`.
    walls : tuple of float
        Values of x at the walls.
    edges : tuple of float arrays (m,)
        Positions of the walls in the history.
    half : float
        Half the distance between the walls.
    limits : ((float, float), (float, float)) or None
        Limits of the portrait's axes; those of x may be descending.
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
    """Return the data of an orbit's pictures, with about `points` samples."""
    model = orbit.model
    return _of_cavity(orbit, model, points) if isinstance(model, Model) else _of_states(orbit, points)


def _of_cavity(orbit: Orbit, model: Model, points: int) -> Shown:
    """Data for a built-in machine: relative velocity against relative position (left wall on the left), and both bodies over forcing periods."""
    params, table, motion = orbit.params, orbit.events, orbit.sample(points)
    gauges = model.gauges(("w", "w_rate"), params)
    (long, length), (fast, velocity) = (gauges.get(name, (1.0, "")) for name in ("w", "w_rate"))
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
    """Data for a declared machine: second state against first, and all states over time."""
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
    """Return the events with markers and names."""
    alphabet, sides = orbit.word.alphabet, {"L": " left", "R": " right"}
    marks = dict(zip(alphabet.letters, MARKS * 9))
    names = {
        text: f"{NAMES[letter.kind]}{sides.get(text, '')}" if alphabet.alone is not None else f"after {text}"
        for text, letter in alphabet.letters.items()
    }
    return [
        Happening(text, marks[text], names[text], float(t), float(a), float(b), h if h is None else float(h))
        for text, t, a, b, h in zip(orbit.word.events, at, x, y, heights)
    ]


def quantities(orbit: Orbit) -> dict[str, str]:
    """Return the parameters of an orbit by name as text: quantities with units, or dimensionless numbers.

    Parameters
    ----------
    orbit : Orbit
    """
    about = orbit.model.described(orbit.params)
    units = about.get("units", {})
    return {
        name: f"{value:.6g} {units.get(name, '')}".rstrip() for name, value in about["parameters"].items()
    }


def track(orbit: Orbit, motion: dict[str, np.ndarray]) -> dict[str, Any] | None:
    """Return positions of bodies and walls of a declared machine over a period; None if no state is the rate of another one.

    A body is a state whose rate is also a state. A wall is drawn at the distance of its gap from the body that it pushes, on the side
    from which it pushes. A contact between two bodies is not drawn.

    Parameters
    ----------
    orbit : Orbit
    motion : dict
        Result of its method `sample`.

    Returns
    -------
    dict or None
        "bodies": state name -> positions; "walls": list of dicts with "name", positions "at", and "side" (+1 at the larger positions);
        "periods".
    """
    from orbits.machines.page.machine import Machine

    rates = _rates(orbit.model.node_names[1:], motion)
    if not rates:
        return None
    bodies = {velocity: place for place, velocity in rates.items()}
    walls, machine = [], orbit.model
    names, p = machine.node_names[1:], Named("p", orbit.parameters)
    rows = np.column_stack([motion[name] for name in names])
    phases = motion["phase"] if machine.forced else [NoPhase()] * len(rows)
    path = [(States(names, row), phase) for row, phase in zip(rows, phases, strict=True)]
    for contact in machine.contacts if isinstance(machine, Machine) else ():
        if not isinstance(contact, Wall):
            continue
        pushed = [name for name in contact.push if name in bodies]
        if len(pushed) != 1:
            continue
        push = contact.push[pushed[0]]  # change of the velocity by a unit impulse
        if callable(push):
            push = push(*path[0], p)
        elif isinstance(push, str):
            push = orbit.parameters[push]
        side = -1 if push > 0.0 else 1
        gaps = np.array([float(contact.gap(*at, p)) for at in path])
        walls.append({"name": contact.letter, "at": motion[bodies[pushed[0]]] + side * gaps, "side": side})
    return {
        "bodies": {place: motion[place] for place in rates},
        "walls": walls,
        "periods": orbit.periods,
    }


def _rates(states: tuple[str, ...], motion: dict[str, np.ndarray]) -> dict[str, str]:
    """Return position -> rate among the states, found by comparing differences in time along the flights."""
    inside = np.diff(motion["segment"]) == 0
    steps = np.diff(motion["time"])[inside]
    found: dict[str, str] = {}
    for place in states:
        moved = np.diff(motion[place])[inside]
        for rate in states:
            expected = (0.5 * (motion[rate][1:] + motion[rate][:-1]))[inside] * steps
            size = float(np.abs(moved).max(initial=0.0))
            if (
                rate != place
                and rate not in found.values()
                and size > 0.0
                and np.abs(moved - expected).max() < ALIKE * size
            ):
                found[place] = rate
                break
    return found


def scene(orbit: Orbit, points: int = 120) -> dict[str, Any]:
    """Return the curves of one period as a dict for JSON.

    Parameters
    ----------
    orbit : Orbit
    points : int
        Approximate number of samples.

    Returns
    -------
    dict
        ``portrait`` (x, y, names, walls, whether x grows to the left), ``history`` (forcing periods or time, curves by name,
        walls), ``animation`` (positions of cavity and absorber, evenly spaced in time; for a declared machine the result of
        `track`), ``events``.
    """
    data = shown(orbit, points)
    return {
        "portrait": {
            "x": data.x,
            "y": data.y,
            "names": list(data.names),
            "walls": list(data.walls),
            "reversed": bool(data.walls),
        },
        "history": {
            "x": data.clock,
            "name": data.time,
            "unit": data.unit,
            "curves": {name: curve.values for name, curve in data.curves.items()},
            "walls": list(data.edges),
        },
        "animation": data.animation,
        "events": [{"event": e.letter, "at": e.at, "x": e.x, "y": e.y} for e in data.events],
    }
