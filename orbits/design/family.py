"""A family of machines: one machine with many values of its parameters, and a first orbit for each of them.

The orbit of a neighbouring machine is carried over by continuation in all parameters at once: Newton's method begins at its nodes; if it
fails, the step is halved.
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


PLACES = 5  # values in the interval `within` at which a first orbit is sought
NARROW = 1.0 / 64.0  # smallest step from one machine to another, relative to the whole way
DRAWN = 3  # random starts at the first, the middle and the last value of a sweep
# forcing periods that are left out: of every motion, and of a motion without a period that may still be a transient
USUAL, LONG = (
    200,
    800,
)
ENDS = 0.01  # relative decrease of the response in a longer simulation; above it the motion was a transient
CLIMBED = 24  # most values to either side of the largest response

Near = tuple[np.ndarray, np.ndarray, tuple[str, ...], tuple[Mode, ...], int]
"""Data of an orbit from which the orbit of a neighbouring machine is computed: nodes, parameter vector, events, modes, periods."""


def settled(model: Varying, params: np.ndarray, state: Start = None) -> Orbit | None:
    """Return the orbit on which the machine settles from rest or from `state`; None if it finds no periodic one that is real."""
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
    """Machines that differ in the values of some parameters.

    Parameters
    ----------
    machine : Model or Machine
        Supplies all parameters that do not vary.
    word : str, optional
        Word of the first orbit; default: that of the motion on which the machine settles from rest.
    periods : int
        Forcing periods after which this orbit closes.
    guess : nested list, optional
        Nodes of this orbit for `machine` itself.
    loose : mapping, optional
        Values of parameters that are no fields of the machine (`amplitude`).
    over, within : optional
        A parameter and an interval; where a machine has no periodic motion, a first orbit is sought at other values in this interval.
    state : mapping, optional
        State in which simulations begin; default: rest.
    tables : sequence of Table
        Parameters that depend on a condition (a temperature); values may then contain the condition.
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
        """Return the first orbit of the machine with these values.

        If no real orbit with the family's word exists, the machine is simulated and the motion on which it settles is returned.

        Parameters
        ----------
        values : mapping
            Parameter name -> value, in the machine's units.
        near : tuple, optional
            Result of `near` for the orbit of a neighbour, or for this orbit itself.

        Raises
        ------
        ValueError
            If there is no machine with these values, or no orbit is found.
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
        """Return the machine with these values, and the values of parameters that are no fields of it."""
        values = resolved(self.tables, values)
        # all parameters of a declared machine belong to its orbits, so the machine itself stays the same
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
        """Simulate one machine and list the motions on which it settles.

        Parameters
        ----------
        values : mapping
            Parameter name -> value of the machine.
        over, at
            The parameter that varies, and its values.
        starts : int
            Simulations at each value: one from rest, the others from random states (the same ones in every call).

        Returns
        -------
        list of (float, dict, str)
            Value of `over`, measures and word of each motion.
        """
        model, loose = self.machine_at(values)
        found = []
        for value in at:
            params = model.vector_at(over, value, loose)
            for attractor, measures in met(model, params, starts, 20, self.state):
                found.append((float(value), measures, attractor.text))
        return found

    def swept(self, values: Mapping[str, float], over: str, at: Sequence[float]) -> list[tuple[float, float]]:
        """Return responses by simulation alone, as (value of `over`, default measure of the machine); see `swept_responses`.

        Parameters
        ----------
        values : mapping
            Parameter name -> value of the machine.
        over, at
            The parameter that varies, and its values, ascending.
        """
        model, loose = self.machine_at(values)
        return swept_responses(model, over, at, loose)

    @staticmethod
    def near(orbit: Orbit) -> Near | None:
        """Return the data from which the orbit of a neighbouring machine is computed; None for a motion without events."""
        word = orbit.word
        return (
            (orbit.nodes, orbit.params, word.events, word.modes, orbit.periods) if len(orbit.nodes) else None
        )

    def starts(
        self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]
    ) -> list[Near | None]:
        """Compute the first orbit of each system from that of its neighbour, and return its `near`.

        Parameters
        ----------
        systems : sequence of mapping
            Parameter values of each system.
        neighbours : sequence of int or None
            Index of an earlier system from which the orbit is carried over; None: the orbit is found without a neighbour.

        Returns
        -------
        list
            `near` of each orbit; None where no orbit was found.
        """
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
        """Continue the orbit `near`, with its word, to the parameter vector `params`; None if it is not real on the way."""
        nodes, first, events, modes, periods = near
        word = model.word_of(events, modes, params)
        if word is None:
            return None
        reached, step = 0.0, 1.0
        while True:
            goal = min(reached + step, 1.0)
            numbers = params if goal == 1.0 else first + goal * (params - first)
            orbit = polish(Orbit(model, word, periods, nodes, numbers))
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
    """Simulate sweeps along a parameter and list the responses of all motions that are met.

    1. One sweep goes up and one goes down through all values.
    2. Random starts at three values add further motions; each is followed in both directions until it joins a motion that is listed already.
    3. The largest response is simulated for longer if it has no period, and followed in smaller steps to its maximum.

    Parameters
    ----------
    model : Model or Machine
    over : str
        The parameter that varies.
    values : sequence of float
        Ascending.
    parameters : mapping
        Values of parameters that are no fields of the machine.

    Returns
    -------
    list of (float, float)
        Value and response (the default measure of the machine); a response may be nan.

    Raises
    ------
    SimulationError
        If a motion of a sweep grows without bound.
    """
    motions = _SweptMotions(model, over, values, parameters)
    motions.run(range(len(values)), None, until_known=False)
    motions.run(range(len(values))[::-1], None, until_known=False)
    population = Population(model, over, parameters)
    for k in sorted({0, len(values) // 2, len(values) - 1}):
        for start in population.starts(DRAWN, 0, values[k]):
            try:
                row = motions.at(values[k], start)
            except SimulationError:  # the motion grows without bound, or begins inside a wall
                continue
            if not motions.knows(row):
                motions.rows.append(row)
                for run in (range(k + 1, len(values)), range(k)[::-1]):
                    motions.run(run, row.detail.state, until_known=True)
    motions.confirm()
    motions.climb()
    motions.confirm()
    return [(row.value, motions.response(row)) for row in motions.rows]


class _SweptMotions:
    """The motions that simulations have met so far (`rows`), and the steps of `swept_responses`."""

    def __init__(
        self, model: Varying, over: str, values: Sequence[float], parameters: Mapping[str, float]
    ) -> None:
        self.model, self.over, self.values = model, over, values
        self.numbers: dict[str, Any] = {name: x for name, x in parameters.items() if name != over}
        self.measure = flow_of(model).default_measure(model)
        self.rows: list[SweepRow] = []

    def at(self, value: float, start: Start, transient: float = USUAL) -> SweepRow:
        """Simulate from `start` at one value; return the motion on which it settles."""
        options = {"transient": transient, "exponents": False}
        (row,) = sweep(self.model, self.over, [value], start=start, **options, **self.numbers)
        return row

    def response(self, row: SweepRow) -> float:
        return float(row.measures.get(self.measure, math.nan))

    def knows(self, row: SweepRow) -> bool:
        """Whether this motion is listed at its value already; all motions without a period count as one."""
        listed, response = [other for other in self.rows if other.value == row.value], self.response(row)
        return any(
            abs(self.response(other) - response) <= DESIGNING.agreement * abs(response)
            if row.periods and other.periods
            else row.periods == other.periods
            for other in listed
        )

    def run(self, places: Sequence[int], start: Start, until_known: bool) -> None:
        """Follow a motion along values with the indices `places`; with `until_known`, stop at a motion that is listed already."""
        for k in places:
            row = self.at(self.values[k], start)
            if until_known and self.knows(row):
                return
            self.rows.append(row)
            start = row.detail.state

    def confirm(self) -> None:
        """Simulate the motion with the largest response for longer while it has no period, because it may be a slow transient."""
        while True:
            top = max(self.rows, key=lambda row: _number(self.response(row)))
            if top.periods:
                return
            longer = self.at(top.value, top.detail.state, LONG)
            if not self.response(longer) < (1.0 - ENDS) * self.response(top):
                return
            self.rows[:] = [longer if row is top else row for row in self.rows]

    def climb(self) -> None:
        """Follow the largest response in both directions while it grows; halve the step where it does not.

        The motion may continue beyond the values of the sweep at which it was lost, up to its end; smaller steps follow it there.
        """
        span, spacing = self.values[-1] - self.values[0], self.values[1] - self.values[0]
        top = max(self.rows, key=lambda row: _number(self.response(row)))
        for side in (-1, 1):
            highest, step = top, 0.5 * spacing
            for _ in range(CLIMBED):
                value = min(max(highest.value + side * step, self.values[0]), self.values[-1])
                if step < DESIGNING.narrow * span or value == highest.value:
                    break
                row = self.at(value, highest.detail.state)
                self.rows.append(row)
                if _number(self.response(row)) > _number(self.response(highest)):
                    highest = row
                else:
                    step *= 0.5


def _number(response: float) -> float:
    return response if math.isfinite(response) else -math.inf
