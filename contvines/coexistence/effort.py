"""Work that has gone into an atlas, beside its budget."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

BUDGET = 500_000  # units of work that an atlas may take where no number is given
PERIODS = 100  # simulated forcing periods, or steps of a map, that take about as long as a point of a branch


class Effort:
    """Work so far, counted in points of branches; the same on every machine, however busy.

    Parameters
    ----------
    population : Population
        Whose ``work``, if it has any, are the periods simulated so far.
    budget : int
    points : callable
        Returns how many points of branches there are so far.
    """

    def __init__(self, population: Any, budget: int, points: Callable[[], int]) -> None:
        self.population, self.budget, self.points = population, budget, points
        self.begun = self._simulated()

    def _simulated(self) -> float:
        return float(getattr(self.population, "work", 0.0))

    @property
    def spent(self) -> int:
        """Points of branches, and simulated periods in units of :data:`PERIODS`."""
        return int(self.points() + (self._simulated() - self.begun) / PERIODS)

    @property
    def over(self) -> bool:
        """Whether no further piece of work may begin."""
        return self.spent >= self.budget

    @property
    def share(self) -> float:
        """Of the budget, at most 1."""
        return min(self.spent / self.budget, 1.0)


def recall_work(population: Any, work: float) -> None:
    """Count work that an earlier run has done and that is not done again."""
    if work:
        population.work = getattr(population, "work", 0.0) + work
