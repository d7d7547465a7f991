"""Work done by an atlas relative to its budget, and estimates of the work that is left."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..problems.abilities import Population

BUDGET = 500_000  # default budget of an atlas, in units of work; some minutes
PERIODS = 100  # simulated forcing periods, or steps of a map, per unit: about the time of a point of a branch


class Effort:
    """Counter of work, in units of a point of a branch in closed form, so that it does not depend on the computer's speed.

    Parameters
    ----------
    population : Population
        Its ``work`` is the number of periods simulated so far, its ``price`` the cost of a point or period relative to a closed-form one.
    budget : int
        Largest number of units.
    points : callable
        Returns the number of points of branches so far, points with many unknowns counted several times.
    """

    def __init__(self, population: Population, budget: int, points: Callable[[], int]) -> None:
        self.population, self.budget, self.points = population, budget, points
        self.work_before, self.started = population.work, monotonic()
        self.waiting: dict[str, int] = {}  # number of known pieces left, by kind of work
        # number of finished pieces and their seconds, by kind of work
        self._took: dict[str, tuple[int, float]] = {}

    @property
    def spent(self) -> int:
        """Units of work done so far, by points of branches and by simulation."""
        return int(
            self.population.price * (self.points() + (self.population.work - self.work_before) / PERIODS)
        )

    @property
    def over(self) -> bool:
        """Whether no further piece of work may begin."""
        return self.spent >= self.budget

    def expect(self, search: str, pieces: int) -> None:
        """Set the number of pieces of a kind of work that are left, as far as known."""
        self.waiting[search] = pieces

    @contextmanager
    def piece(self, search: str) -> Iterator[None]:
        """Measure the time of one piece of a kind of work, as a context manager."""
        began = monotonic()
        yield
        count, seconds = self._took.get(search, (0, 0.0))
        self._took[search] = count + 1, seconds + monotonic() - began
        self.waiting[search] = max(self.waiting.get(search, 0) - 1, 0)

    def left(self) -> tuple[float, int, int, float]:
        """Return the progress of the atlas.

        Returns
        -------
        share : float
            Used share of the budget.
        done, known : int
            Numbers of finished pieces and of all known pieces.
        seconds : float
            Estimated time that the known pieces left, or the rest of the budget, will take; nan before the first piece is finished.
        """
        done, waiting = sum(count for count, _ in self._took.values()), sum(self.waiting.values())
        share, seconds = min(self.spent / self.budget, 1.0), float("nan")
        if done:
            mean = sum(seconds for _, seconds in self._took.values()) / done
            took = {search: self._took.get(search, (1, mean)) for search in self.waiting}
            seconds = sum(n * took[search][1] / took[search][0] for search, n in self.waiting.items())
            if share:
                seconds = min(seconds, (monotonic() - self.started) * (1.0 / share - 1.0))
        return share, done, done + waiting, seconds
