"""The motion of a declared machine seen once per period of a cycle, by simulation.

The section is where the forcing passes phase zero; of a self-excited machine just after the event with which the cycle begins.
"""

from __future__ import annotations

import numpy as np

from orbits.contacts.wall import Wall
from orbits.declared.stepper import TWO_PI, SimulationError, Stepper
from orbits.declared.variations import Variations
from orbits.machines.page.machine import Machine
from orbits.words.of_pages import PageWord

LONGEST = 1e3  # clock without the event of the section after which a motion does not come back


class Section:
    """A section of the motions of a declared machine.

    Parameters
    ----------
    machine : Machine
    params : ndarray, shape (P,)
    word : PageWord
        Of the cycle.
    periods : int
        Forcing periods of the cycle.
    index : int
        Of the parameter by which `varied` differentiates.
    """

    def __init__(
        self, machine: Machine, params: np.ndarray, word: PageWord, periods: int, index: int
    ) -> None:
        self.machine, self.params, self.periods = machine, params, periods
        self.modes = word.modes[0]
        letter = word.letter(0) if len(word) else None
        self.event = None if letter is None else (letter.contact, letter.kind)
        self.times = sum(
            (word.letter(i).contact, word.letter(i).kind) == self.event for i in range(len(word))
        )
        self.stepper = Stepper(machine, params)
        self.index = index

    @property
    def names(self) -> tuple[str, ...]:
        """The states."""
        return tuple(self.machine.states)

    def through(self, u: np.ndarray) -> np.ndarray:
        """Where the motion that begins with the first of the nodes u meets the section, shape (d,)."""
        node = np.asarray(u, dtype=float)[: self.machine.size + 1]
        if not self.machine.forced:
            return node[1:].copy()
        self.stepper.start(node[1:], float(node[0]), self.modes)
        return self._until(self.stepper.base + TWO_PI)

    def rounds(self, u: np.ndarray) -> np.ndarray:
        """Where the cycle meets the section, once per forcing period, shape (periods, d); of a self-excited machine, one point."""
        first = self.through(u)
        if not self.machine.forced:
            return first[None]
        begun = self.stepper.base + self.stepper.clock
        return np.array([first, *(self._until(begun + TWO_PI * k) for k in range(1, self.periods))])

    def step(self, x: np.ndarray) -> np.ndarray:
        """One period of the cycle later; NaN where the motion does not come back."""
        try:
            if self.machine.forced:
                self.stepper.start(x, 0.0)
                return self._until(TWO_PI * self.periods)
            self.stepper.start(x, 0.0, self.modes)
            return self._events()
        except SimulationError:
            return np.full(self.machine.size, np.nan)

    def _until(self, clock: float) -> np.ndarray:
        while self.stepper.advance(clock) is not None:
            pass
        return self.stepper.state.copy()

    def _events(self) -> np.ndarray:
        left = self.times
        while left:
            found = self.stepper.advance(self.stepper.base + self.stepper.clock + LONGEST)
            if found is None:
                return np.full(self.machine.size, np.nan)
            left -= found[:2] == self.event
        return self.stepper.state.copy()

    def struck(self, x: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Of a point at a wall the other one there, just after the impact or just before it, and the direction away from the wall; None elsewhere.

        Where the forcing passes phase zero; the points just after the events of a self-excited machine are not told apart.
        """
        if not self.machine.forced:
            return None
        compiled, x = self.stepper.compiled, np.array(x, dtype=float)
        numbers = compiled.numbers(self.params, self.modes)
        gaps = compiled.contact_values().one(x, 0.0, numbers)
        for j, contact in enumerate(self.machine.contacts):
            if not isinstance(contact, Wall):
                continue
            slopes = compiled.gap_slopes(j).one(x, 0.0, numbers)
            steep = float(np.linalg.norm(slopes))
            if not abs(gaps[j]) < near * steep:
                continue
            here = x - gaps[j] * slopes / steep**2
            row = compiled.impact_map(j).one(here, 0.0, numbers)
            jump, rate = row[:-1] - here, row[-1]
            if (
                rate > 0.0
            ):  # it is the state after an impact: the impulse was larger by 1/restitution and the other way round
                jump = jump / compiled.rebound(j).one(here, 0.0, numbers)[1]
            if rate != 0.0 and np.all(np.isfinite(jump)):
                return here + jump, slopes / steep
        return None

    def varied(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """`step` with its derivatives by x, shape (d, d), and by the parameter, shape (d,); NaN where a wall holds the body."""
        n, stepper = self.machine.size, self.stepper
        nowhere = np.full(n, np.nan), np.full((n, n), np.nan), np.full(n, np.nan)
        try:
            stepper.start(x, 0.0, None if self.machine.forced else self.modes)
            passage = Variations(stepper, self.index)
            if self.machine.forced:
                while passage.advance(TWO_PI * self.periods) is not None:
                    pass
            else:
                left = self.times
                while left:
                    found = passage.advance(stepper.base + stepper.clock + LONGEST)
                    if found is None:
                        return nowhere
                    left -= found[:2] == self.event
        except SimulationError:
            return nowhere
        return stepper.state.copy(), *passage.derivatives
