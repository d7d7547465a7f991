"""Work that has gone into an atlas, beside its budget, and what is left of it as far as that is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..problems.abilities import Population

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
        # pieces of each search that are done, and their seconds
        self._took: dict[str, tuple[int, float]] = {}

    @property
    def spent(self) -> int:
        """Points of branches, and simulated periods in units of :data:`PERIODS`, at their price."""
        return int(self.population.price * (self.points() + (self.population.work - self.begun) / PERIODS))

    @property
    def over(self) -> bool:
        """Whether no further piece of work may begin."""
        return self.spent >= self.budget

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

    def left(self) -> tuple[float, int, int, float]:
        """Share of the budget that is used; pieces of work that are done, and known so far; the time that the others, or the rest of the budget, will
        take, as far as that is known: NaN before the first is done."""
        done, known = sum(count for count, _ in self._took.values()), sum(self.waiting.values())
        share, seconds = min(self.spent / self.budget, 1.0), float("nan")
        if done:
            mean = sum(seconds for _, seconds in self._took.values()) / done
            took = {search: self._took.get(search, (1, mean)) for search in self.waiting}
            seconds = sum(n * took[search][1] / took[search][0] for search, n in self.waiting.items())
            if share:
                seconds = min(seconds, (monotonic() - self.started) * (1.0 / share - 1.0))
        return share, done, done + known, seconds
