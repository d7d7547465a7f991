"""A simulated motion: its events, and its states at any time between them."""

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
    """A simulated motion; subclasses give the states between the events.

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
        Kinds of the events (`orbits.contacts`).
    status : int
        Reason for the end of the run (`orbits.machines.stepping`); `ended` gives it in words.
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
        """Whether the run reached its requested end."""
        return self.status == TIME_REACHED

    @property
    def stopped(self) -> bool:
        """Whether no further event will ever happen."""
        return self.status == REST

    @cached_property
    @abstractmethod
    def letters(self) -> Sequence[str]:
        """Letters of the events."""

    @property
    @abstractmethod
    def occurrences(self) -> Sequence[Hashable]:
        """Letter of each event with the modes after it; equal entries are equal events."""

    @property
    @abstractmethod
    def held(self) -> bool:
        """Whether a wall holds the body during the whole run."""

    @property
    def reason(self) -> str:
        """The reason for the end of the run."""
        return STATUS[self.status]

    @abstractmethod
    def flown(self, places: np.ndarray, ahead: np.ndarray) -> np.ndarray:
        """Return the motion at clocks `ahead` after the start (place 0) or after event `place` (from 1 on), shape (m, c).

        The first columns are the simulator's coordinates.
        """

    def at(self, clocks: np.ndarray) -> np.ndarray:
        """Return the motion at clocks within the run, shape (m, c), as `flown` does.

        Raises
        ------
        ValueError
            If a clock lies outside the run.
        """
        first, last = float(self.clocks[0]), self.finish
        slack = SIMULATING.whole_period * max(1.0, abs(last))
        if clocks.size and (clocks.min() < first - slack or clocks.max() > last + slack):
            raise ValueError(
                f"phases from {clocks.min():g} to {clocks.max():g} leave the run, which lasts "
                f"from {first:g} to {last:g}; simulate more periods"
            )
        places = np.clip(np.searchsorted(self.clocks, clocks, side="right") - 1, 0, len(self.kinds))
        return self.flown(places, np.maximum(clocks - self.clocks[places], 0.0))

    def coordinates(self, times: np.ndarray) -> np.ndarray:
        """Return the simulator's coordinates at times within the run (forcing periods, or time over 2 pi), shape (m, d)."""
        return self.at(TWO_PI * times)[:, : self.points.shape[1]]

    @property
    @abstractmethod
    def nodes(self) -> np.ndarray:
        """Unknowns of continuation at every event of a forced machine, shape (m, n)."""

    @abstractmethod
    def cycle(self, first: int, last: int) -> tuple[Word, np.ndarray]:
        """Return word and nodes of the cycle that consists of events `first` to `last` - 1."""

    @abstractmethod
    def approaches(self, first: int = 0) -> np.ndarray:
        """Return the approach speeds of the impacts from event `first` on, in the machine's own units."""

    @abstractmethod
    def extremes(self, per_period: int = 0) -> dict[str, float]:
        """Return the extremes of the motion by name: the measures ``max_...`` and ``min_...`` of a simulation.

        `per_period` is the number of samples per forcing period; 0: as many as are needed.
        """

    @abstractmethod
    def responses(self, per_period: int) -> tuple[np.ndarray, np.ndarray]:
        """Return clocks along the run, and the response from which modulations are measured at these clocks."""

    def shown(self, first: int) -> list[float]:
        """Return one value for each event from `first` on that a picture plots; empty if it plots the whole motion."""
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
        """Events at which infinitely many impacts accumulate or a wall releases the body, bool array (m,)."""
        return (self.kinds == HOLD) | (self.kinds == RELEASE)

    @property
    def impacts(self) -> int:
        """Number of impacts."""
        return int(np.count_nonzero(self.hits))

    @property
    def chatters(self) -> int:
        """How often infinitely many impacts accumulated and a wall held the body."""
        return int(np.count_nonzero(self.kinds == HOLD))

    @property
    def times(self) -> np.ndarray:
        """Times of the events, in forcing periods, or time over 2 pi."""
        return self.clocks[1:] / TWO_PI

    @property
    def lasted(self) -> float:
        """Length of the run, in forcing periods, or time over 2 pi."""
        return float(self.finish - self.clocks[0]) / TWO_PI

    @property
    def impact_times(self) -> np.ndarray:
        """Instants of the impacts, in the machine's time."""
        speed = float(self.model.phase_speed(self.params))
        return self.clocks[1:][self.hits] / speed * float(self.model.gauge("time", self.params))

    @property
    def ended(self) -> str:
        """The reason for the end of the run, and how often impacts accumulated."""
        times = "" if self.chatters == 0 else "once" if self.chatters == 1 else f"{self.chatters} times"
        return self.reason + (f"; impacts piled up and a wall held the body {times}" if times else "")

    @cached_property
    def labels(self) -> np.ndarray:
        """One number for each event, the same for equal events, int array (m,)."""
        numbers: dict[Hashable, int] = {}
        return np.array([numbers.setdefault(event, len(numbers)) for event in self.occurrences], dtype=int)
