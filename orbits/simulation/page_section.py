"""Sections of declared machines, which know the derivatives of their steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.flows.page.variations import Variations
from orbits.flows.protocol import SimulationError
from orbits.simulation.page import TWO_PI, PageSimulator
from orbits.simulation.section import Section

if TYPE_CHECKING:
    from orbits.flows.page.stepper import Stepper
    from orbits.words import Word

LONGEST = 1e3  # clock without the event of the section after which a motion does not come back


class VariedSection(Section):
    """A section that knows the derivatives of its steps: of a declared machine.

    Parameters
    ----------
    index : int
        Of the parameter by which `varied` differentiates.
    """

    simulator: PageSimulator

    def __init__(self, simulator: PageSimulator, word: Word, periods: int, index: int) -> None:
        super().__init__(simulator, word, periods, np.ones(len(simulator.names) + 1))
        self.index = index

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`step` with its derivatives by x, shape (d, d), and by the parameter, shape (d,); NaN where a wall holds the body."""
        n, stepper = len(x), self.simulator.stepper
        try:
            self._start(x)
            passage = Variations(stepper, self.index)
            self._go(passage)
        except SimulationError:
            return np.full(n, np.nan), np.full((n, n), np.nan), np.full(n, np.nan)
        return stepper.state.copy(), *passage.derivatives

    def _start(self, x: np.ndarray) -> None:
        self.simulator.start(x)

    def _go(self, mover: Variations | Stepper) -> None:
        """Move on by a period of the cycle."""
        while mover.advance(TWO_PI * self.periods) is not None:
            pass


class EventSection(VariedSection):
    """The section of a self-excited machine."""

    def __init__(self, simulator: PageSimulator, word: Word, periods: int, index: int) -> None:
        super().__init__(simulator, word, periods, index)
        letters = [word.letter(i) for i in range(len(word))]
        first = letters[0] if letters else None
        self.event = None if first is None else (first.contact, first.kind)
        self.times = sum((letter.contact, letter.kind) == self.event for letter in letters)

    def rounds(self, u: np.ndarray, count: int | None = None) -> np.ndarray:
        """The states just after the first event, shape (1, d)."""
        return np.array([np.asarray(u, dtype=float)[1 : len(self.unit)]])

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later; NaN where the motion does not come back."""
        try:
            self._start(x)
            self._go(self.simulator.stepper)
        except SimulationError:
            return np.full(len(x), np.nan)
        return self.simulator.point

    def _start(self, x: np.ndarray) -> None:
        self.simulator.start(x, 0.0, self.word.modes[0])

    def _go(self, mover: Variations | Stepper) -> None:
        left = self.times
        while left:
            stepper = self.simulator.stepper
            found = mover.advance(stepper.base + stepper.clock + LONGEST)
            if found is None:
                raise SimulationError("the event of the section does not come again")
            left -= found[:2] == self.event


def section_of(model: Any, params: np.ndarray, word: Word, periods: int, index: int) -> VariedSection:
    """The section of a cycle, with derivatives by the parameter `index` too."""
    simulator = PageSimulator(model, params)
    return (VariedSection if model.forced else EventSection)(simulator, word, periods, index)
