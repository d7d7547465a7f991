"""The compiled functions of one declared machine, made at first use and kept as long as the machine exists."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

import numpy as np

from orbits.contacts import HIT, SLIP, STICK, SWITCH, TURN, Letter
from orbits.integrators.engine import engine
from orbits.integrators.expressions import Values, derivatives, replaced, variable, variables_of
from orbits.integrators.protocol import Flight, Flights, Run, Watch
from orbits.machines.page.patterns import Equations, PatternKey
from orbits.symbols import Symbol

Made = TypeVar("Made")
Key = ParamSpec("Key")


def once(make: Callable[Concatenate[Compiled, Key], Made]) -> Callable[Concatenate[Compiled, Key], Made]:
    """Decorator for a method of `Compiled` whose result is made at the first call with the same arguments."""

    @wraps(make)
    def cached(self: Compiled, *args: Key.args, **named: Key.kwargs) -> Made:
        key = (make.__name__, args)
        if key not in self.cache:
            self.cache[key] = make(self, *args, **named)
        return self.cache[key]

    return cached


class Compiled:
    """Flights, guards, events and rates of a machine, for each pattern.

    Parameters
    ----------
    equations : Equations
    """

    def __init__(self, equations: Equations) -> None:
        self.equations, self.layout = equations, equations.layout
        self.n = len(equations.states)
        self.cache: dict[Hashable, Any] = {}
        self.engine = engine()

    def _values(self, *values: Symbol) -> Values:
        return self.engine.Values(self.layout, values)

    @once
    def flight(self, key: PatternKey, active: tuple[int, ...]) -> Flight:
        """Return the flow with its derivatives."""
        return self.engine.Flight(self.layout, self.equations.pattern(key).clock_rates, active)

    @once
    def flights(self, key: PatternKey, active: tuple[int, ...]) -> Flights:
        """Return the flow with its derivatives, several flights at once."""
        return self.engine.Flights(self.layout, self.equations.pattern(key).clock_rates, active)

    @once
    def run(self, key: PatternKey) -> Run:
        """Return the flow up to the first guard that falls to zero."""
        pattern = self.equations.pattern(key)
        return self.engine.Run(self.layout, pattern.clock_rates, [g.value for g in pattern.guards])

    @once
    def watch(self, key: PatternKey) -> Watch:
        """Return the flow that reports every local minimum of every guard."""
        pattern = self.equations.pattern(key)
        rises = [pattern.rate(g.value) for g in pattern.guards]
        return self.engine.Watch(self.layout, pattern.clock_rates, rises)

    @once
    def extremes(self, key: PatternKey) -> Watch:
        """Return the flow that reports every extreme of every state: rises of the rates (minima) and of minus the rates (maxima)."""
        rates = self.equations.pattern(key).clock_rates
        return self.engine.Watch(self.layout, rates, [*rates, *(-rate for rate in rates)])

    @once
    def rates(self, key: PatternKey) -> Values:
        """Return the derivatives of the states by the clock: n values."""
        return self._values(*self.equations.pattern(key).clock_rates)

    @once
    def guards(self, key: PatternKey) -> Values:
        """Return the guards, then their time derivatives."""
        pattern = self.equations.pattern(key)
        values = [g.value for g in pattern.guards]
        return self._values(*values, *(pattern.rate(v) for v in values))

    def event(self, letter: Letter, sign: int, key: PatternKey, active: tuple[int, ...]) -> Values:
        """Return the function that is zero at an event, with derivatives by states, clock and active numbers.

        At an impact the states after it follow, each with its derivatives.
        """
        return self._event(letter.contact, letter.kind, sign if letter.kind == SLIP else 0, key, active)

    @once
    def _event(self, contact: int, kind: int, sign: int, key: PatternKey, active: tuple[int, ...]) -> Values:
        values = [self._zero(contact, kind, sign, key)]
        if kind == HIT:
            values += self.equations.impact(contact)
        return self._varied(values, active)

    def _varied(self, values: Sequence[Symbol], active: tuple[int, ...]) -> Values:
        """Return values, each with its derivatives by states, clock and active numbers."""
        e = self.equations
        variables = [*e.x, e.clock, *(variable(self.layout.numbers[i]) for i in active)]
        table = [[value, *row] for value, row in zip(values, derivatives(values, variables))]
        return self._values(*(entry for row in table for entry in row))

    @once
    def extreme(self, key: PatternKey, active: tuple[int, ...]) -> Values:
        """Return the rate of the first state that moves, with derivatives: it is zero at the node of a self-excited motion without events."""
        rates = self.equations.pattern(key).rates
        return self._varied([rates[moving(self.equations, rates)]], active)

    def _zero(self, j: int, kind: int, sign: int, key: PatternKey) -> Symbol:
        e = self.equations
        if kind == HIT:
            return e.gap[j]
        if kind in (TURN, STICK):
            return e.velocity[j]
        if kind == SWITCH:
            return e.surface[j]
        guards = e.pattern(key).guards
        found = [g.value for g in guards if g.contact == j and g.kind == SLIP and g.sign == sign]
        if not found:
            raise ValueError(f"a slip of {e.contacts[j].name!r} follows a flight in which it does not stick")
        return found[0]

    @once
    def contact_values(self) -> Values:
        """Return gaps, velocities and surfaces: one value per contact, in any mode."""
        e = self.equations
        every = {**e.gap, **e.velocity, **e.surface}
        return self._values(*(every[j] for j in range(len(e.contacts))))

    @once
    def limits(self, frictions: tuple[int, ...]) -> Values:
        """Return the largest forces of these frictions."""
        return Values(self.layout, [self.equations.limit[j] for j in frictions])

    @once
    def impact_map(self, wall: int) -> Values:
        """Return the states after an impact, the gap's rate before it, then velocities and surfaces of `signed` contacts after it."""
        e, after = self.equations, self.equations.impact(wall)
        places = dict(zip(self.layout.states, after))
        signs = [replaced((e.velocity | e.surface)[j], places) for j in e.signed]
        return self._values(*after, e.gap_rate(wall), *signs)

    @once
    def rebound(self, wall: int) -> Values:
        """Return the rate of a gap and the wall's restitution."""
        e = self.equations
        return self._values(e.gap_rate(wall), e.restitution[wall])

    @once
    def loads(self, wall: int) -> Values:
        """Return the rate of a gap, the wall's restitution and the mass of the relative motion."""
        e = self.equations
        return self._values(e.gap_rate(wall), e.restitution[wall], e.impact_mass(wall))

    @once
    def friction_power(self, key: PatternKey) -> Values:
        """Return the power lost in the frictions: one value."""
        return self._values(self.equations.pattern(key).friction_power())

    @once
    def energy(self) -> Values:
        """Return the energy of all bodies: one value."""
        assert self.equations.energy is not None
        return self._values(self.equations.energy)

    @once
    def approach(self, wall: int) -> Values:
        """Return the rate of a gap, its derivatives by the states, and the wall's push."""
        e, rate = self.equations, self.equations.gap_rate(wall)
        return self._values(rate, *derivatives([rate], e.x)[0], *e.push[wall])

    @once
    def gap_slopes(self, wall: int) -> Values:
        """Return the derivatives of a gap by the states."""
        e = self.equations
        return self._values(*derivatives([e.gap[wall]], e.x)[0])

    @once
    def settled(self, wall: int) -> Values:
        """Return the states after an impulse that reduces the rate of a gap to zero."""
        return self._values(*self.equations.impact(wall, rest=True))

    @once
    def gap_acceleration(self, wall: int, key: PatternKey) -> Values:
        """Return the second derivative of a free wall's gap: one value."""
        e = self.equations
        return self._values(e.pattern(key).rate(e.gap_rate(wall)))

    def numbers(self, params: np.ndarray, modes: Sequence[int]) -> np.ndarray:
        """Return the runtime numbers of a mode: parameters, then signs."""
        return np.concatenate([params, self.equations.signs(modes)])


def moving(equations: Equations, rates: Sequence[Symbol]) -> int:
    """Return the first state whose rate depends on the states."""
    names = set(equations.layout.states)
    return next((j for j, rate in enumerate(rates) if variables_of(rate) & names), 0)
