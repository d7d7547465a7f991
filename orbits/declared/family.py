"""A family of machines from one page: its parameters take many values, and each has an orbit to begin with.

It is what a survey asks of a machine: the contract is that of `orbits.design.Family`. Worker processes run the page themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from orbits.attractors.page import polished
from orbits.attractors.search import find_attractor
from orbits.attractors.sweep import sweep
from orbits.declared.starts import find
from orbits.flows.page.stepper import Stepper
from orbits.flows.protocol import SimulationError
from orbits.machines.page.loading import load_page
from orbits.machines.page.machine import Machine
from orbits.orbit import Orbit
from orbits.simulation.page import outside
from orbits.starts.find import StartError
from orbits.words.of_pages import PageWord

PLACES = 5  # where an orbit is looked for in the interval
NARROW = 1.0 / 64.0  # the least part of the way from a neighbour that is tried


@dataclass(frozen=True, eq=False)
class PageFamily:
    """Machines of one page that differ in some parameters.

    Parameters
    ----------
    page, name : str
        The file, and the machine on it.
    parameters : mapping
        In place of the page's own.
    word : str, optional
        Of the orbit to begin with; without it the attractor that `state` leads to.
    periods : int
    guess : nested list, optional
    state : mapping, optional
    over, within : optional
        A parameter and its interval in which an orbit to begin with may lie elsewhere.
    """

    page: str
    name: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    word: str | None = None
    periods: int = 1
    guess: Any = None
    state: Mapping[str, float] | None = None
    over: str | None = None
    within: tuple[float, float] | None = None

    @property
    def machine(self) -> Machine:
        """The machine; the page is run once a process."""
        return load_page(self.page, self.name)

    def __call__(self, values: Mapping[str, float], near: Any = None) -> Orbit:
        """The orbit of the machine with these values.

        Raises
        ------
        ValueError
            If the values make no machine, or no orbit is found.
        """
        machine, given = self.machine, {**self.parameters, **values}
        params = machine.vector(given)
        orbit = None if near is None else self._carried(machine, params, near)
        if orbit is not None:
            return orbit
        refusal = None
        if self.word is not None:
            try:
                orbit = find(machine, self.word, self.periods, self.guess, given)
                if orbit.real:
                    return orbit
            except StartError as error:
                refusal = error
        places = (
            [] if self.over is None or self.within is None else np.linspace(*self.within, PLACES + 2)[1:-1]
        )
        for changed in ({}, *({str(self.over): float(value)} for value in places)):
            try:
                fixed: dict[str, Any] = {**given, **changed}
                orbit = find_attractor(machine, self.state, **fixed).orbit
            except SimulationError as error:
                refusal = StartError(str(error))
                continue
            if orbit is not None:
                return orbit
        raise refusal or StartError("the simulator finds no periodic motion to begin with; give a word")

    @staticmethod
    def near(orbit: Orbit) -> Any:
        """What a neighbour's orbit may begin with."""
        return orbit.nodes, orbit.params, orbit.word.events, orbit.word.modes, orbit.periods

    def starts(self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]) -> list[Any]:
        """`near` of each system's own orbit, each carried over from its neighbour; None where that fails."""
        found: list[Any] = []
        for values, neighbour in zip(systems, neighbours):
            before = None if neighbour is None else found[neighbour]
            try:
                if before is not None:
                    params = self.machine.vector({**self.parameters, **values})
                    orbit = self._carried(self.machine, params, before)
                else:
                    orbit = self(values) if neighbour is None else None
            except ValueError:
                orbit = None
            found.append(None if orbit is None else self.near(orbit))
        return found

    def simulated(
        self, values: Mapping[str, float], over: str, at: Sequence[float], starts: int
    ) -> list[tuple[float, dict[str, float], str]]:
        """Motions on which simulations settle, from the study's start and from random ones: value of `over`, measures, word."""
        machine, given, found = self.machine, {**self.parameters, **values}, []
        fixed: dict[str, Any] = {key: number for key, number in given.items() if key != over}
        for value in at:
            generator = np.random.default_rng(20)
            stepper = Stepper(machine, machine.vector({**given, over: value}))
            for trial in range(starts):
                start = (
                    dict(self.state or {}) if trial == 0 else machine.random_start(stepper.params, generator)
                )
                phase = start.pop("phase", 0.0)
                state = outside(stepper, np.array([start.get(s, 0.0) for s in machine.states]), phase)
                try:
                    (row,) = sweep(machine, over, [value], start=np.append(phase, state), **fixed)
                except SimulationError:
                    continue
                found.append((float(value), row.measures, row.word))
        return found

    @staticmethod
    def _carried(machine: Machine, params: np.ndarray, near: Any) -> Orbit | None:
        """The orbit at `params` from one nearby with the same word: Newton's method over the whole way, or part after part."""
        nodes, here, events, modes, periods = near
        word = PageWord(tuple(events), tuple(map(tuple, modes)), machine.alphabet)
        orbit, reached, step = None, 0.0, 1.0
        while reached < 1.0:
            goal = min(reached + step, 1.0)
            there = params if goal == 1.0 else here + goal * (params - here)
            orbit = polished(Orbit(machine, word, periods, nodes, there))
            if orbit is None or not orbit.real:
                step *= 0.5
                if step < NARROW:
                    return None
                continue
            nodes, word, periods, reached = orbit.nodes, orbit.word, orbit.periods, goal
        return orbit


__all__ = ["PageFamily"]
