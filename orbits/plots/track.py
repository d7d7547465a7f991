"""What moves in a declared machine, for an animation: bodies, and the walls that stop them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.contacts.wall import Wall
from orbits.machines.page.formulas import Named, NoPhase, States

if TYPE_CHECKING:
    from orbits.orbit import Orbit

ALIKE = 0.02  # a state is the rate of another one if it is within this share of it


def track(orbit: Orbit, motion: dict[str, np.ndarray]) -> dict[str, Any] | None:
    """Bodies and walls over a period, on one line; None where no state is the rate of another one.

    A body is a state whose rate is a state, too. A wall stands at its gap from the body that it pushes, on the side
    from which it pushes; two bodies that push one another need none.

    Parameters
    ----------
    orbit : Orbit
    motion : dict
        Its `sample`.

    Returns
    -------
    dict or None
        "bodies": positions by the states' names; "walls": "name", "at" and "side" (+1: beyond larger positions) of each;
        "periods".
    """
    from orbits.machines.page.machine import Machine

    rates = _rates(orbit.model.node_names[1:], motion)
    if not rates:
        return None
    bodies = {velocity: place for place, velocity in rates.items()}
    walls = []
    machine = orbit.model
    for contact in machine.contacts if isinstance(machine, Machine) else ():
        if not isinstance(contact, Wall):
            continue
        pushed = [name for name in contact.push if name in bodies]
        if len(pushed) == 1:
            gaps = _gaps(orbit, contact, motion)
            side = -1.0 if _number(contact.push[pushed[0]], orbit, motion) > 0.0 else 1.0
            walls.append(
                {"name": contact.letter, "at": motion[bodies[pushed[0]]] + side * gaps, "side": int(side)}
            )
    return {
        "bodies": {place: motion[place] for place in rates},
        "walls": walls,
        "periods": orbit.periods,
    }


def _rates(states: tuple[str, ...], motion: dict[str, np.ndarray]) -> dict[str, str]:
    """Which state is the rate of which, judged by their differences in time along the flights."""
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


def _states(orbit: Orbit, motion: dict[str, np.ndarray]) -> list[tuple[States, Any]]:
    names = orbit.model.node_names[1:]
    rows = np.column_stack([motion[name] for name in names])
    phases = motion["phase"] if orbit.model.forced else [NoPhase()] * len(rows)
    return [(States(names, row), phase) for row, phase in zip(rows, phases, strict=True)]


def _gaps(orbit: Orbit, contact: Wall, motion: dict[str, np.ndarray]) -> np.ndarray:
    p = Named("p", orbit.parameters)
    return np.array([float(contact.gap(state, phase, p)) for state, phase in _states(orbit, motion)])


def _number(push: float | str | Callable, orbit: Orbit, motion: dict[str, np.ndarray]) -> float:
    """What a unit impulse does to a velocity, at the start of the period."""
    if callable(push):
        state, phase = _states(orbit, motion)[0]
        return float(push(state, phase, Named("p", orbit.parameters)))
    return float(orbit.parameters[push] if isinstance(push, str) else push)
