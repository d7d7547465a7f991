"""What a flow, the motion between two events, is asked about, and what a simulator of it answers.

The stepping half, in words
---------------------------
A *simulator* moves one motion of a machine on at given parameters, from event to event. It knows no word, no equation of cycles and no border.

1. Time is counted in forcing periods (of a self-excited machine: in 2 pi of its time), whole ones included. A *point* is where the motion is at a
   given time: the coordinates `names`, positions and velocities.
2. ``start(point, time, modes=None)`` puts the motion there. What is in contact, and how it slides, follows from the point unless it is given.
3. ``follow(until)`` moves it on; what may happen (gaps that close, velocities that vanish, limits of friction that are reached, switches that
   are crossed) is looked for all the way, and the laws of the contacts are applied. No event, hop or touch is passed unseen.
4. ``record(until, most)`` does the same and lists the events.
5. A motion that cannot go on (it leaves the range of numbers, or a law does not continue it) or cannot begin raises `SimulationError`.
6. ``struck(point, near)`` tells the two points that are one motion at a wall: just before and just after the impact.
7. ``mirrored`` says that the ``image`` of a point, half a period later, is a point of the same machine. ``hard`` says which coordinates walls limit by themselves.
   ``watched`` is (periods, events) of the motion in which near returns are looked for.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from contvines.shared.near_names import did_you_mean


class Motion(Protocol):
    """What a flow is asked about: word, nodes and parameters of a cycle (`orbits.cycles.cycle.Cycle`)."""

    @property
    def model(self) -> Any: ...
    @property
    def word(self) -> Any: ...
    @property
    def periods(self) -> int: ...
    @property
    def nodes(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def durations(self) -> np.ndarray: ...


class SimulationError(ValueError):
    """A start or a length of a run that cannot be, or a motion that does not go on; the sentence says what would do."""


def told(start: Mapping[str, float], allowed: Sequence[str]) -> dict[str, float]:
    """The entries of a start as numbers.

    Raises
    ------
    SimulationError
        If a name is unknown or a value not finite.
    """
    for key, value in start.items():
        if key not in allowed:
            raise SimulationError(
                f"start has no entry {key!r}{did_you_mean(key, allowed)}; it may have {', '.join(allowed)}"
            )
        if not math.isfinite(float(value)):
            raise SimulationError(f"start: {key} = {value!r} is not finite; give a number")
    return {key: float(value) for key, value in start.items()}


@dataclass(frozen=True, eq=False)
class Record:
    """Events of a motion, one after the other.

    Attributes
    ----------
    times : float array (m,)
        Forcing periods.
    points : float array (m, d)
        Just after the events.
    events : sequence of hashable
        What happened, and the modes after it.
    impacts, piled : bool array (m,)
        Which are impacts; with which infinitely many impacts end, or a wall lets go.
    whole : bool
        Whether the record goes on to the time asked for.
    source : Any
        The simulation's own account.
    """

    times: np.ndarray
    points: np.ndarray
    events: Sequence[Hashable]
    impacts: np.ndarray
    piled: np.ndarray
    whole: bool
    source: Any

    def __len__(self) -> int:
        return len(self.times)


class Simulator(Protocol):
    """A motion on its way; the contract is at the top of this module."""

    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def forced(self) -> bool: ...
    @property
    def mirrored(self) -> bool: ...
    @property
    def hard(self) -> np.ndarray: ...
    @property
    def watched(self) -> tuple[float, int]: ...
    @property
    def time(self) -> float: ...
    @property
    def point(self) -> np.ndarray: ...

    def image(self, point: np.ndarray) -> np.ndarray: ...

    def start(self, point: np.ndarray, time: float = 0.0, modes: Any = None) -> None: ...

    def begin(self, word: Any, node: np.ndarray) -> None:
        """Put the motion just after the first event of a cycle with this word, of which `node` are the unknowns."""
        ...

    def follow(self, until: float) -> None: ...

    def record(self, until: float, most: int) -> Record: ...

    def struck(self, point: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None: ...


def later(
    simulator: Simulator, point: np.ndarray, length: float, time: float = 0.0, modes: Any = None
) -> np.ndarray:
    """Where the motion through a point is so much later; NaN where it does not get there."""
    try:
        simulator.start(point, time, modes)
        simulator.follow(time + length)
    except SimulationError:
        return np.full(len(point), np.nan)
    return simulator.point
