"""The compiled functions of one declared machine, made when they are first asked for and kept as long as it lives."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any, TypeVar

import numpy as np

from orbits.contacts.letters import HIT, SLIP, STICK, SWITCH, TURN, Letter
from orbits.integrators.engine import engine
from orbits.integrators.expressions import Values, derivatives, replaced, variable, variables_of
from orbits.integrators.protocol import Flight, Flights, Run, Watch
from orbits.machines.page.energies import friction_power, impact_mass
from orbits.machines.page.patterns import Equations, PatternKey
from orbits.symbols import Symbol

T = TypeVar("T")


class Compiled:
    """Flights, guards, events and rates of a machine, by pattern.

    Parameters
    ----------
    equations : Equations
    """

    def __init__(self, equations: Equations) -> None:
        self.equations, self.layout = equations, equations.layout
        self.n = len(equations.states)
        self._made: dict[Hashable, Any] = {}
        self.engine = engine()

    def _once(self, key: Hashable, make: Callable[[], T]) -> T:
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def flight(self, key: PatternKey, active: tuple[int, ...]) -> Flight:
        """The flow with its sensitivities."""
        return self._once(
            ("flight", key, active),
            lambda: self.engine.Flight(self.layout, self.equations.pattern(key).clock_rates, active),
        )

    def flights(self, key: PatternKey, active: tuple[int, ...]) -> Flights:
        """The same, several at once."""
        return self._once(
            ("flights", key, active),
            lambda: self.engine.Flights(self.layout, self.equations.pattern(key).clock_rates, active),
        )

    def run(self, key: PatternKey) -> Run:
        """The flow up to the first guard that falls to zero."""
        pattern = self.equations.pattern(key)
        return self._once(
            ("run", key),
            lambda: self.engine.Run(self.layout, pattern.clock_rates, [g.value for g in pattern.guards]),
        )

    def watch(self, key: PatternKey) -> Watch:
        """The flow with every local minimum of every guard."""
        pattern = self.equations.pattern(key)
        return self._once(
            ("watch", key),
            lambda: self.engine.Watch(
                self.layout, pattern.clock_rates, [pattern.rate(g.value) for g in pattern.guards]
            ),
        )

    def extremes(self, key: PatternKey) -> Watch:
        """The flow with every extreme of every state: rises of the rates are minima, rises of minus the rates maxima."""
        rates = self.equations.pattern(key).clock_rates
        return self._once(
            ("extremes", key),
            lambda: self.engine.Watch(self.layout, rates, [*rates, *(-rate for rate in rates)]),
        )

    def rates(self, key: PatternKey) -> Values:
        """Derivatives of the states by the clock: n values."""
        return self._once(
            ("rates", key), lambda: self.engine.Values(self.layout, self.equations.pattern(key).clock_rates)
        )

    def guards(self, key: PatternKey) -> Values:
        """The guards, then their time derivatives."""
        pattern = self.equations.pattern(key)

        def make() -> Values:
            values = [g.value for g in pattern.guards]
            return self.engine.Values(self.layout, [*values, *(pattern.rate(v) for v in values)])

        return self._once(("guards", key), make)

    def event(self, letter: Letter, sign: int, key: PatternKey, active: tuple[int, ...]) -> Values:
        """The function that is zero at an event, its derivatives by states, clock and active numbers, and at an impact the
        states after it with theirs, state by state."""

        def make() -> Values:
            e = self.equations
            values = [self._zero(letter, sign, key)]
            if letter.kind == HIT:
                values += e.impact(letter.contact)
            return self._varied(values, active)

        wanted = sign if letter.kind == SLIP else 0
        return self._once(("event", letter.contact, letter.kind, wanted, key, active), make)

    def _varied(self, values: Sequence[Symbol], active: tuple[int, ...]) -> Values:
        """Values, each with its derivatives by states, clock and active numbers."""
        e = self.equations
        by = [*e.x, e.clock, *(variable(self.layout.numbers[i]) for i in active)]
        table = [[value, *row] for value, row in zip(values, derivatives(values, by))]
        return self.engine.Values(self.layout, [entry for row in table for entry in row])

    def extreme(self, key: PatternKey, active: tuple[int, ...]) -> Values:
        """The rate of the first state that moves, and its derivatives: zero where a self-excited motion without events is counted from."""

        def make() -> Values:
            e = self.equations
            rates = e.pattern(key).rates
            return self._varied([rates[moving(e, rates)]], active)

        return self._once(("extreme", key, active), make)

    def _zero(self, letter: Letter, sign: int, key: PatternKey) -> Symbol:
        e, j = self.equations, letter.contact
        if letter.kind == HIT:
            return e.gap[j]
        if letter.kind in (TURN, STICK):
            return e.velocity[j]
        if letter.kind == SWITCH:
            return e.surface[j]
        guards = e.pattern(key).guards
        found = [g.value for g in guards if g.contact == j and g.kind == SLIP and g.sign == sign]
        if not found:
            raise ValueError(f"a slip of {e.contacts[j].name!r} follows a flight in which it does not stick")
        return found[0]

    def contact_values(self) -> Values:
        """Gaps, velocities and surfaces: one value per contact, in any mode."""
        e = self.equations
        every = {**e.gap, **e.velocity, **e.surface}
        return self._once(
            "contacts", lambda: self.engine.Values(self.layout, [every[j] for j in range(len(e.contacts))])
        )

    def limits(self, frictions: tuple[int, ...]) -> Values:
        """Largest forces of these frictions."""
        limit = self.equations.limit
        return self._once("limits", lambda: Values(self.layout, [limit[j] for j in frictions]))

    def impact_map(self, wall: int) -> Values:
        """The states after an impact, the gap's rate before it, then what the signs of frictions and switches follow after it, contact by contact."""
        e = self.equations

        def make() -> Values:
            after = e.impact(wall)
            places = dict(zip(self.layout.states, after))
            signs = [replaced((e.velocity | e.surface)[j], places) for j in e.signed]
            return self.engine.Values(self.layout, [*after, e.gap_rate(wall), *signs])

        return self._once(("impact", wall), make)

    def rebound(self, wall: int) -> Values:
        """The rate of a gap and the wall's restitution."""
        e = self.equations
        return self._once(
            ("rebound", wall),
            lambda: self.engine.Values(self.layout, [e.gap_rate(wall), e.restitution[wall]]),
        )

    def loads(self, wall: int) -> Values:
        """The rate of a gap, the wall's restitution and the mass of the relative motion."""
        e = self.equations
        return self._once(
            ("loads", wall),
            lambda: self.engine.Values(
                self.layout, [e.gap_rate(wall), e.restitution[wall], impact_mass(e, wall)]
            ),
        )

    def friction_power(self, key: PatternKey) -> Values:
        """The power that the frictions take: one value."""
        return self._once(
            ("friction", key),
            lambda: self.engine.Values(self.layout, [friction_power(self.equations.pattern(key))]),
        )

    def energy(self) -> Values:
        """The energy of all bodies: one value."""
        energy = self.equations.energy
        assert energy is not None
        return self._once("energy", lambda: self.engine.Values(self.layout, [energy]))

    def approach(self, wall: int) -> Values:
        """The rate of a gap, its slopes by the states, and the wall's push."""
        e = self.equations

        def make() -> Values:
            rate = e.gap_rate(wall)
            return self.engine.Values(self.layout, [rate, *derivatives([rate], e.x)[0], *e.push[wall]])

        return self._once(("approach", wall), make)

    def gap_slopes(self, wall: int) -> Values:
        """Derivatives of a gap by the states."""
        e = self.equations
        return self._once(
            ("slopes", wall), lambda: self.engine.Values(self.layout, derivatives([e.gap[wall]], e.x)[0])
        )

    def settled(self, wall: int) -> Values:
        """The states after an impulse that takes the rate of a gap away."""
        e = self.equations
        return self._once(
            ("settled", wall), lambda: self.engine.Values(self.layout, e.impact(wall, rest=True))
        )

    def gap_acceleration(self, wall: int, key: PatternKey) -> Values:
        """Second derivative of a free wall's gap: one value."""
        e = self.equations
        return self._once(
            ("acceleration", wall, key),
            lambda: self.engine.Values(self.layout, [e.pattern(key).rate(e.gap_rate(wall))]),
        )

    def numbers(self, params: np.ndarray, modes: Sequence[int]) -> np.ndarray:
        """The runtime numbers of a mode: parameters, then signs."""
        return np.concatenate([params, self.equations.signs(modes)])


def moving(equations: Equations, rates: Sequence[Symbol]) -> int:
    """The first state whose rate depends on the states."""
    names = set(equations.layout.states)
    return next((j for j, rate in enumerate(rates) if variables_of(rate) & names), 0)
