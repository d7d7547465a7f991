"""Work that has gone into an atlas, beside its budget, and what is left of it as far as that is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .population import Population

BUDGET = 500_000  # units of work that an atlas may take where no number is given: some minutes
PERIODS = 100  # simulated forcing periods, or steps of a map, that take about as long as a point of a branch


class Effort:
    """Work so far, counted in points of branches in closed form; the same on every computer, however busy.

    Parameters
    ----------
    population : Population
        Whose ``work`` are the periods simulated so far, and ``price`` what a point or a period costs beside one in closed form.
    budget : int
    points : callable
        Returns how many points of branches there are so far, those of many unknowns counted several times.
    """

    def __init__(self, population: Population, budget: int, points: Callable[[], int]) -> None:
        self.population, self.budget, self.points = population, budget, points
        self.begun, self.started = population.work, monotonic()
        self.waiting: dict[str, int] = {}  # pieces of each search that are known so far
        self._took: dict[
            str, tuple[int, float]
        ] = {}  # pieces of each search that are done, and their seconds

    @property
    def spent(self) -> int:
        """Points of branches, and simulated periods in units of :data:`PERIODS`, at their price."""
        return int(self.population.price * (self.points() + (self.population.work - self.begun) / PERIODS))

    @property
    def over(self) -> bool:
        """Whether no further piece of work may begin."""
        return self.spent >= self.budget

    @property
    def share(self) -> float:
        """Of the budget, at most 1."""
        return min(self.spent / self.budget, 1.0)

    def expect(self, search: str, pieces: int) -> None:
        """So many pieces of a search are known to be left."""
        self.waiting[search] = pieces

    @contextmanager
    def piece(self, search: str) -> Iterator[None]:
        """The time of one of them."""
        begun = monotonic()
        yield
        count, seconds = self._took.get(search, (0, 0.0))
        self._took[search] = count + 1, seconds + monotonic() - begun
        self.waiting[search] = max(self.waiting.get(search, 0) - 1, 0)

    @property
    def pieces(self) -> tuple[int, int]:
        """Pieces of work that are done, and that are known so far."""
        done = sum(count for count, _ in self._took.values())
        return done, done + sum(self.waiting.values())

    @property
    def seconds(self) -> float:
        """Estimate of the time that the pieces known so far, or the rest of the budget, will take; NaN before the first is done."""
        done, _ = self.pieces
        if not done:
            return float("nan")
        mean = sum(seconds for _, seconds in self._took.values()) / done
        left = 0.0
        for search, pieces in self.waiting.items():
            count, seconds = self._took.get(search, (1, mean))
            left += pieces * seconds / count
        share = self.share
        return min(left, (monotonic() - self.started) * (1.0 / share - 1.0)) if share else left
