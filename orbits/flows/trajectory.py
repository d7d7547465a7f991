"""A simulated motion: its events, and where it is at any time between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from orbits.contacts import HIT, HOLD, RELEASE
from orbits.machines.stepping import REST, STATUS, TIME_REACHED
from orbits.settings import SIMULATING
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

TWO_PI = 2.0 * np.pi
ModelOf = TypeVar("ModelOf", bound="Varying", covariant=True)


@dataclass(frozen=True, eq=False)
class Trajectory(ABC, Generic[ModelOf]):
    """A simulated motion; a flow says what lies between the events.

    Attributes
    ----------
    model : Model or Machine
    params : float array (P,)
        Parameter vector of the run.
    clocks : float array (m + 1,)
        Phase (of a self-excited machine: time) of the start and of every event, counted through: 2 pi per forcing period.
    finish : float
        Clock at which the run ended.
    kinds : int array (m,)
        What the events do (`orbits.contacts`).
    status : int
        Why the run ended (`orbits.machines.stepping`); `ended` says it in words.
    """

    model: ModelOf
    params: np.ndarray
    clocks: np.ndarray
    finish: float
    kinds: np.ndarray
    status: int

    @property
    @abstractmethod
    def points(self) -> np.ndarray:
        """The simulator's coordinates just after the events, shape (m, d)."""

    @property
    def whole(self) -> bool:
        """Whether the run goes on to the time asked for."""
        return self.status == TIME_REACHED

    @property
    def stopped(self) -> bool:
        """Whether nothing will ever happen again."""
        return self.status == REST

    @cached_property
    @abstractmethod
    def letters(self) -> Sequence[str]:
        """The events as they are written."""

    @property
    @abstractmethod
    def occurrences(self) -> Sequence[Hashable]:
        """What happened at the events, with the modes after them: events that are alike are equal."""

    @property
    @abstractmethod
    def held(self) -> bool:
        """Whether a wall holds the body from the beginning to the end."""

    @property
    def reason(self) -> str:
        """Why the run ended."""
        return STATUS[self.status]

    @abstractmethod
    def flown(self, places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """What a flow knows, shape (m, c), so long (clock) after the start (place 0) and the events (from 1 on): coordinates first."""

    def at(self, clocks: np.ndarray) -> np.ndarray:
        """The same at clocks within the run.

        Raises
        ------
        ValueError
            If a clock lies outside the run.
        """
        first, last = float(self.clocks[0]), self.finish
        slack = SIMULATING.whole * max(1.0, abs(last))
        if clocks.size and (clocks.min() < first - slack or clocks.max() > last + slack):
            raise ValueError(
                f"phases from {clocks.min():g} to {clocks.max():g} leave the run, which lasts "
                f"from {first:g} to {last:g}; simulate more periods"
            )
        places = np.clip(np.searchsorted(self.clocks, clocks, side="right") - 1, 0, len(self.kinds))
        return self.flown(places, np.maximum(clocks - self.clocks[places], 0.0))

    def coordinates(self, times: np.ndarray) -> np.ndarray:
        """The simulator's coordinates at times within the run (forcing periods, or time over 2 pi), shape (m, d)."""
        return self.at(TWO_PI * times)[:, : self.points.shape[1]]

    @property
    @abstractmethod
    def nodes(self) -> np.ndarray:
        """What continuation solves for, at every event of a forced machine, shape (m, n)."""

    @abstractmethod
    def cycle(self, first: int, last: int) -> tuple[Word, np.ndarray]:
        """Word and nodes of a cycle that events `first` to `last` - 1 are."""

    @abstractmethod
    def approaches(self, first: int = 0) -> np.ndarray:
        """Approach speeds of the impacts from event `first` on, in the machine's own numbers."""

    @abstractmethod
    def extremes(self, per_period: int = 0) -> dict[str, float]:
        """By name how far the motion goes, looked at so often (0: as often as it takes): the measures ``max_...`` and ``min_...`` of a simulation."""

    @abstractmethod
    def responses(self, per_period: int) -> tuple[np.ndarray, np.ndarray]:
        """Clocks all along the run, and at these what modulations are told by."""

    def shown(self, first: int) -> list[float]:
        """What a picture shows of the events from `first` on; nothing where it shows the whole motion."""
        return self.approaches(first).tolist()

    # ------------------------------------------------------------------ what follows
    def __len__(self) -> int:
        return len(self.kinds)

    @cached_property
    def hits(self) -> np.ndarray:
        """Which events are impacts, bool array (m,)."""
        return self.kinds == HIT

    @cached_property
    def piled(self) -> np.ndarray:
        """With which events infinitely many impacts end, or a wall lets go, bool array (m,)."""
        return (self.kinds == HOLD) | (self.kinds == RELEASE)

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return int(np.count_nonzero(self.hits))

    @property
    def chatters(self) -> int:
        """How often infinitely many impacts piled up and a wall held the body."""
        return int(np.count_nonzero(self.kinds == HOLD))

    @property
    def times(self) -> np.ndarray:
        """Of the events, in forcing periods, or time over 2 pi."""
        return self.clocks[1:] / TWO_PI

    @property
    def lasted(self) -> float:
        """The same of the whole run."""
        return float(self.finish - self.clocks[0]) / TWO_PI

    @property
    def impact_times(self) -> np.ndarray:
        """Instants of the impacts, in the machine's time."""
        speed = float(self.model.phase_speed(self.params))
        return self.clocks[1:][self.hits] / speed * float(self.model.gauge("time", self.params))

    @property
    def ended(self) -> str:
        """Why the run ended, and whether impacts piled up on the way."""
        times = "" if self.chatters == 0 else "once" if self.chatters == 1 else f"{self.chatters} times"
        return self.reason + (f"; impacts piled up and a wall held the body {times}" if times else "")

    @cached_property
    def labels(self) -> np.ndarray:
        """A number for each event, the same for events that are alike, int array (m,)."""
        known: dict[Hashable, int] = {}
        return np.array([known.setdefault(event, len(known)) for event in self.occurrences], dtype=int)
