"""A family of machines: one machine whose parameters take many values, and an orbit of each to begin with.

An orbit of a neighbour is carried over by continuation in all parameters at once: Newton's method from its nodes, over half the way
where the whole is too far.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.attractors.search import find_attractor, met
from orbits.attractors.sweeping import SweepRow, sweep
from orbits.contacts import Mode
from orbits.flows import flow_of
from orbits.flows.protocol import SimulationError
from orbits.machines.parameters import Table, resolved
from orbits.orbit import Orbit
from orbits.population import Population
from orbits.settings import DESIGNING
from orbits.simulation.runs import Start
from orbits.starts.find import StartError, centred, find, polish

if TYPE_CHECKING:
    from orbits.machines.varying import Varying


PLACES = 5  # where an orbit is looked for in the interval
NARROW = 1.0 / 64.0  # the least part of the way that is tried
DRAWN = 3  # starts at the first, the middle and the last value
USUAL, LONG = (
    200,
    800,
)  # forcing periods that are left out, and of a motion without a period that may be a transient
ENDS = 0.01  # relative fall of the response by which a transient is known
CLIMBED = 24  # values to either side of the largest response

Near = tuple[np.ndarray, np.ndarray, tuple[str, ...], tuple[Mode, ...], int]
"""What a neighbour's orbit may begin with: nodes, parameter vector, events, modes, periods."""


def settled(model: Varying, params: np.ndarray, state: Start = None) -> Orbit | None:
    """The orbit to which the machine settles from rest, or from a state; None where nothing recurs."""
    values: dict[str, Any] = model.named(params)
    found = find_attractor(model, state, max_period=8, **values)
    if found.kind == "stuck":
        return Orbit.at_rest(model, params)
    if found.word is None:
        return None
    orbit = found.found.root()
    centred(model, orbit.word, orbit.nodes)
    orbit = polish(orbit)
    return orbit if orbit is not None and orbit.real else None


@dataclass(frozen=True, eq=False)
class Family:
    """Machines that differ in some parameters.

    Parameters
    ----------
    machine : Model or Machine
        The parameters that do not vary.
    word : str, optional
        Of the orbit to begin with; without it the one to which the machine settles from rest.
    periods : int
    guess : nested list, optional
        Nodes of that orbit in `machine` itself.
    loose : mapping, optional
        Parameters that belong to the orbit rather than to the machine.
    over, within : optional
        A parameter and its interval in which an orbit to begin with may lie elsewhere, where the machine itself has none.
    state : mapping, optional
        Where simulations begin that look for such an orbit: at rest by default.
    tables : sequence of Table
        Parameters that depend on a condition; values may then name the condition.
    """

    machine: Varying
    word: str | None = None
    periods: int = 1
    guess: Sequence[Sequence[float]] | np.ndarray | None = None
    loose: Mapping[str, float] | None = None
    over: str | None = None
    within: tuple[float, float] | None = None
    state: Mapping[str, float] | None = None
    tables: Sequence[Table] = ()

    @property
    def notation(self) -> dict[str, str]:
        """Labels of axes by name of parameter or measure."""
        return self.machine.notation

    def __call__(self, values: Mapping[str, float], near: Near | None = None) -> Orbit:
        """The orbit of the machine with these values, counted in its units.

        Where the orbit with the family's word does not exist, the one to which the machine settles from rest.

        Parameters
        ----------
        values : mapping
        near : tuple, optional
            `near` of a neighbour's orbit, or of this very one.

        Raises
        ------
        ValueError
            If the values make no machine, or no orbit is found.
        """
        model, loose = self.machine_at(values)
        if near is not None:
            orbit = self._carried(model, model.vector(loose), near)
            if orbit is not None:
                return orbit
        refusal = None
        try:
            orbit = None if self.word is None else find(model, self.word, self.periods, self.guess, loose)
            if orbit is not None and orbit.real:
                return orbit
        except StartError as error:
            refusal = error
        places = [
            model.vector(loose),
            *(model.vector_at(self.over or "", x, loose) for x in self._elsewhere()),
        ]
        orbit = None
        for params in places:
            try:
                orbit = orbit or settled(model, params, self.state)
            except SimulationError as error:
                refusal = refusal or StartError(str(error))
        if orbit is None:
            raise refusal or StartError(
                "the simulator finds no periodic motion to begin with; give a word, or another interval"
                if self.word is None
                else f"the orbit {self.word!r} is no real one here, and the simulator finds no periodic motion to begin with"
            )
        return orbit

    def machine_at(self, values: Mapping[str, float]) -> tuple[Varying, dict[str, float]]:
        """The machine with these values, and the parameters left to its orbits."""
        values = resolved(self.tables, values)
        # a physical machine counts in its units; the numbers of a page are all its orbits'
        change = getattr(self.machine, "with_", None) or getattr(self.machine, "changed", None)
        if change is None:
            return self.machine, {**(self.loose or {}), **values}
        own = {name: value for name, value in values.items() if name not in (self.loose or {})}
        loose = {**(self.loose or {}), **{name: value for name, value in values.items() if name not in own}}
        return change(**own) if own else self.machine, loose

    def _elsewhere(self) -> list[float]:
        return (
            []
            if self.over is None or self.within is None
            else np.linspace(*self.within, PLACES + 2)[1:-1].tolist()
        )

    def simulated(
        self, values: Mapping[str, float], over: str, at: Sequence[float], starts: int
    ) -> list[tuple[float, dict[str, float], str]]:
        """Motions on which simulations settle: value of `over`, measures, word.

        Parameters
        ----------
        values : mapping
            Of the machine.
        over, at
            The parameter that is set to each of these.
        starts : int
            Simulations at each: from rest, then from states drawn at random (always the same ones).
        """
        model, loose = self.machine_at(values)
        found = []
        for value in at:
            params = model.vector_at(over, value, loose)
            for attractor, measures in met(model, params, starts, 20, self.state):
                found.append((float(value), measures, attractor.text))
        return found

    def swept(self, values: Mapping[str, float], over: str, at: Sequence[float]) -> list[tuple[float, float]]:
        """Responses by simulation alone: values of `over` and the machine's usual measure.

        Parameters
        ----------
        values : mapping
            Of the machine.
        over, at
            The parameter, and its values, ascending.
        """
        model, loose = self.machine_at(values)
        return swept_responses(model, over, at, loose)

    @staticmethod
    def near(orbit: Orbit) -> Near | None:
        """What a neighbour's orbit may begin with: nodes, parameter vector, events, modes, periods."""
        word = orbit.word
        return (
            (orbit.nodes, orbit.params, word.events, word.modes, orbit.periods) if len(orbit.nodes) else None
        )

    def starts(
        self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]
    ) -> list[Near | None]:
        """`near` of each system's own orbit, each carried over from its neighbour; None where that fails."""
        found: list[Near | None] = []
        for values, neighbour in zip(systems, neighbours):
            before = None if neighbour is None else found[neighbour]
            try:
                model, loose = self.machine_at(values)
                if before is None:
                    orbit = self(values) if neighbour is None else None
                else:
                    orbit = self._carried(model, model.vector(loose), before)
                found.append(None if orbit is None else self.near(orbit))
            except ValueError:
                found.append(None)
        return found

    def _carried(self, model: Varying, params: np.ndarray, near: Near) -> Orbit | None:
        """The orbit at `params` from one nearby, both with the word of the latter."""
        nodes, here, events, modes, periods = near
        word = model.word_of(events, modes, params)
        if word is None:
            return None
        reached, step = 0.0, 1.0
        while True:
            goal = min(reached + step, 1.0)
            there = params if goal == 1.0 else here + goal * (params - here)
            orbit = polish(Orbit(model, word, periods, nodes, there))
            if orbit is None or not orbit.real:
                step *= 0.5
                if step < NARROW:
                    return None
                continue
            if goal == 1.0:
                return orbit
            nodes, reached = orbit.nodes, goal


def swept_responses(
    model: Varying, over: str, values: Sequence[float], parameters: Mapping[str, float]
) -> list[tuple[float, float]]:
    """Motions that simulations settle on: at each value those of a sweep up and one down, and those that drawn starts add, each followed both ways
    to where another one takes over; the largest response is followed to its top, and for longer where it has no period.

    Parameters
    ----------
    model : Model or Machine
    over : str
    values : sequence of float
        Ascending.
    parameters : mapping
        Those that are no fields of the machine.

    Returns
    -------
    list of (float, float)
        Value and response (the measure that is shown); the latter may be no number.

    Raises
    ------
    SimulationError
        If a motion runs away.
    """
    seen = _Seen(model, over, values, parameters)
    seen.run(range(len(values)), None, until_known=False)
    seen.run(range(len(values))[::-1], None, until_known=False)
    population = Population(model, over, parameters)
    for k in sorted({0, len(values) // 2, len(values) - 1}):
        for start in population.starts(DRAWN, 0, values[k]):
            try:
                row = seen.at(values[k], start)
            except SimulationError:  # it runs away, or begins inside a wall
                continue
            if not seen.knows(row):
                seen.rows.append(row)
                for run in (range(k + 1, len(values)), range(k)[::-1]):
                    seen.run(run, row.detail.state, until_known=True)
    seen.confirm()
    seen.climb()
    seen.confirm()
    return [(row.value, seen.response(row)) for row in seen.rows]


class _Seen:
    """Motions that were met."""

    def __init__(
        self, model: Varying, over: str, values: Sequence[float], parameters: Mapping[str, float]
    ) -> None:
        self.model, self.over, self.values = model, over, values
        self.numbers: dict[str, Any] = {name: x for name, x in parameters.items() if name != over}
        self.measure = flow_of(model).default_measure(model)
        self.rows: list[SweepRow] = []

    def at(self, value: float, start: Start, transient: float = USUAL) -> SweepRow:
        """What a state leads to."""
        ways = {"transient": transient, "exponents": False}
        (row,) = sweep(self.model, self.over, [value], start=start, **ways, **self.numbers)
        return row

    def response(self, row: SweepRow) -> float:
        return float(row.measures.get(self.measure, math.nan))

    def knows(self, row: SweepRow) -> bool:
        """Whether a motion was met at this value already; of those without a period there is one."""
        here, own = [other for other in self.rows if other.value == row.value], self.response(row)
        return any(
            abs(self.response(other) - own) <= DESIGNING.agreement * abs(own)
            if row.periods and other.periods
            else row.periods == other.periods
            for other in here
        )

    def run(self, places: Sequence[int], start: Start, until_known: bool) -> None:
        """Follow a motion along some of the values; to one that is known, if asked."""
        for k in places:
            row = self.at(self.values[k], start)
            if until_known and self.knows(row):
                return
            self.rows.append(row)
            start = row.detail.state

    def confirm(self) -> None:
        """Follow the largest response for longer as long as it is that of a motion without a period: it may be a transient that is slow to end."""
        while True:
            top = max(self.rows, key=lambda row: _number(self.response(row)))
            if top.periods:
                return
            longer = self.at(top.value, top.detail.state, LONG)
            if not self.response(longer) < (1.0 - ENDS) * self.response(top):
                return
            self.rows[:] = [longer if row is top else row for row in self.rows]

    def climb(self) -> None:
        """From the largest response on either way while it grows, in steps that are halved where it does not: a motion that steps of the values lose goes on
        in smaller ones to where it ends."""
        span, spacing = self.values[-1] - self.values[0], self.values[1] - self.values[0]
        top = max(self.rows, key=lambda row: _number(self.response(row)))
        for side in (-1, 1):
            here, step = top, 0.5 * spacing
            for _ in range(CLIMBED):
                value = min(max(here.value + side * step, self.values[0]), self.values[-1])
                if step < DESIGNING.narrow * span or value == here.value:
                    break
                row = self.at(value, here.detail.state)
                self.rows.append(row)
                if _number(self.response(row)) > _number(self.response(here)):
                    here = row
                else:
                    step *= 0.5


def _number(response: float) -> float:
    return response if math.isfinite(response) else -math.inf
