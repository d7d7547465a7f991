"""The formulas of a declared machine as symbols, in every mode.

The functions of the machine file are called once with symbols. A *pattern* is a set of frictions that stick and walls that hold. In each
pattern the unknown contact forces follow from the velocities and gaps that they keep at zero. The signs of sliding frictions and of
switches remain numbers, so that one compiled flow serves all of them.

With the energy E, quadratic in the speeds, and a contact whose unit of force changes the states at the rates d, the force is conjugate to the
contact's speed s: the mass of the relative motion is m = (d . H d) / (ds/dx . d)^2 with the Hessian H of E, an impulse of J newton seconds
changes s by J/m, and a unit of the contact's own force is (d . H d) / (ds/dx . d) newton. Work of the drive of a moving wall or belt is not
counted.

Independent variable (`clock`) of every compiled flow: the forcing phase (radians) of a forced machine, time of a self-excited one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, SupportsFloat

import numpy as np

from orbits.contacts import HIT, RELEASE, SLIP, SWITCH, TURN
from orbits.contacts.dry_friction import ABSENT, STUCK, DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import HELD, Wall
from orbits.integrators.expressions import Layout, constant, derivatives, replaced, variable, variables_of
from orbits.machines.page.page import Named, NoPhase, PageError, States, called
from orbits.symbols import Symbol

if TYPE_CHECKING:
    from collections.abc import Callable

CLOCK = "phase"
Contact = Wall | DryFriction | Switch
PatternKey = tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True)
class Guard:
    """A quantity of one contact that stays positive in a mode, and the event at which it falls to zero.

    `sign` is the sign of the velocity after a slip.
    """

    contact: int
    kind: int
    value: Symbol
    sign: int = 0


class Pattern:
    """The machine while given frictions stick, given walls hold and given frictions are absent.

    Attributes
    ----------
    rates : list of Symbol
        Time derivatives of the states.
    forces, mobility : dict of int to Symbol
        Force of each friction and each held wall, by the contact's index; and, for unknown forces, the acceleration
        by a unit of the force while the other unknown forces keep their conditions.
    """

    def __init__(
        self, equations: Equations, stuck: tuple[int, ...], held: tuple[int, ...], absent: tuple[int, ...]
    ) -> None:
        self.equations, self.stuck, self.held, self.absent = equations, stuck, held, absent
        e = equations
        unknown = {j: variable(f"force_{e.contacts[j].name}") for j in (*stuck, *held)}
        sliding = [j for j in e.velocity if j not in stuck]
        sliding_forces = {j: constant(0.0) if j in absent else -e.limit[j] * e.sign[j] for j in sliding}
        base = e.motion_with({**sliding_forces, **{j: unknown[j] for j in stuck}})
        for j in held:
            base = [r + d * unknown[j] for r, d in zip(base, e.push[j])]
        conditions = [e.along(e.velocity[j], base) for j in stuck]
        conditions += [e.along(e.gap_rate(j), base) for j in held]
        solved, self.mobility = _solved(conditions, unknown)
        self.forces: dict[int, Symbol] = {**sliding_forces, **solved}
        rates = e.motion_with({j: f for j, f in self.forces.items() if j not in held})
        for j in held:
            rates = [r + d * self.forces[j] for r, d in zip(rates, e.push[j])]
        self.rates: list[Symbol] = rates

    def rate(self, value: Symbol) -> Symbol:
        """Return the time derivative of a quantity along this flow."""
        return self.equations.along(value, self.rates)

    @cached_property
    def clock_rates(self) -> list[Symbol]:
        """Derivatives of the states by the clock."""
        omega = self.equations.phase_rate
        return self.rates if omega is None else [rate / omega for rate in self.rates]

    def friction_power(self) -> Symbol:
        """Return the power lost in the frictions, if the machine declares its energy."""
        e, total = self.equations, constant(0.0)
        for j, force in e.force.items():
            if j in self.stuck or j in self.absent:
                continue
            push = [row[0] for row in derivatives(e.rates, [force])]
            newtons = e.curvature(push) / e.toward(e.velocity[j], push)
            total = total - newtons * self.forces[j] * e.velocity[j]
        return total

    @cached_property
    def guards(self) -> list[Guard]:
        """Guards of this pattern, contact by contact."""
        e, found = self.equations, []
        for j, contact in enumerate(e.contacts):
            if isinstance(contact, Wall):
                if j in self.held:
                    found.append(Guard(j, RELEASE, self.forces[j] * self.mobility[j]))
                else:
                    found.append(Guard(j, HIT, e.gap[j]))
            elif isinstance(contact, Switch):
                if not any(
                    e.flips.get((wall, j)) for wall in self.held
                ):  # otherwise the wall keeps it at zero
                    found.append(Guard(j, SWITCH, e.sign[j] * e.surface[j]))
            elif j in self.stuck:
                for sign in (1, -1):
                    reserve = self.mobility[j] * (e.limit[j] + float(sign) * self.forces[j])
                    found.append(Guard(j, SLIP, reserve, sign))
            elif j not in self.absent:
                found.append(Guard(j, TURN, e.sign[j] * e.velocity[j]))
        return found


class Equations:
    """The formulas of a machine file, as symbols.

    Attributes
    ----------
    contacts : tuple of Wall, DryFriction or Switch
    layout : Layout
    sign : dict of int to Symbol
        Sign of a sliding friction or of a switch: a number at run time.
    gap, push, restitution; velocity, limit; surface : dict of int to Symbol (push: list of Symbol)
        Of the walls; the frictions; the switches.
    phase_rate : Symbol or None
    formulas_of_motion : callable
        `motion` of the machine file.
    factors : mapping of str to float
        Unit of a parameter or state in SI units: formulas of the machine file receive SI units, all other code uses the shown units.
    energy : Symbol or None
        Of all bodies, in joules.
    force : dict of int to Symbol
        Of each friction, as an unknown.
    without_forces : dict of str to float
        Names of these unknowns, each with 0.
    flips : dict of (wall, contact) to int or None
        Effect of impacts on the signs of frictions and switches (`orbits.words.alphabet.Alphabet`), as `checks` finds it.
    """

    def __init__(
        self,
        states: tuple[str, ...],
        parameters: tuple[str, ...],
        phase_rate: str | None,
        motion: Callable,
        contacts: tuple[Contact, ...],
        factors: Mapping[str, float] | None = None,
        energy: Callable | None = None,
    ) -> None:
        self.states, self.contacts, self.factors = states, contacts, dict(factors or {})
        self.formulas_of_motion = motion
        self._patterns: dict[PatternKey, Pattern] = {}
        self._deciding: dict[int, frozenset[str]] = {}
        self.flips: Mapping[tuple[int, int], int | None] = {}
        signed = [j for j, c in enumerate(contacts) if isinstance(c, (DryFriction, Switch))]
        numbers = (*(f"p_{name}" for name in parameters), *(f"sign_{contacts[j].name}" for j in signed))
        self.layout = Layout(tuple(f"x_{name}" for name in states), CLOCK, numbers)
        self.signed = tuple(signed)
        self.x = [variable(name) for name in self.layout.states]
        self.clock = variable(CLOCK)
        self.p = Named("p", {name: self._in_si(name, variable(f"p_{name}")) for name in parameters})
        self.sign = {j: variable(f"sign_{contacts[j].name}") for j in signed}
        self.phase_rate = None if phase_rate is None else getattr(self.p, phase_rate)
        self.phase = NoPhase() if phase_rate is None else self.clock
        self.state = States(states, [self._in_si(name, x) for name, x in zip(states, self.x)])
        self.gap, self.push, self.restitution = {}, {}, {}
        self.velocity, self.limit, self.surface = {}, {}, {}
        for j, contact in enumerate(contacts):
            if isinstance(contact, Wall):
                self.gap[j] = self.value(contact.gap, f"the gap of wall {contact.letter!r}")
                self.push[j] = [
                    self.quantity(
                        contact.push.get(name, 0.0), f"the push of wall {contact.letter!r} on {name}"
                    )
                    / self.factors.get(name, 1.0)
                    for name in states
                ]
                self.restitution[j] = self.quantity(
                    contact.restitution, f"the restitution of wall {contact.letter!r}"
                )
            elif isinstance(contact, DryFriction):
                self.velocity[j] = self.value(contact.velocity, f"the velocity of friction {contact.name!r}")
                self.limit[j] = self.quantity(contact.limit, f"the limit of friction {contact.name!r}")
            else:
                self.surface[j] = self.value(contact.surface, f"the surface of switch {contact.name!r}")
        self.energy: Symbol | None = None if energy is None else self.value(energy, "energy")
        self.force = {j: variable(f"force_{contacts[j].name}") for j in self.velocity}
        self.without_forces = {f"force_{contacts[j].name}": 0.0 for j in self.velocity}

    @cached_property
    def rates(self) -> list[Symbol]:
        """Rates of the states with unknown friction forces."""
        return self.motion_with(self.force)

    @cached_property
    def still(self) -> list[Symbol]:
        """Rates of the states without friction forces."""
        return self.motion_with(dict.fromkeys(self.velocity, constant(0.0)))

    # ------------------------------------------------------------------ reading the page
    def value(self, function: object, label: str) -> Symbol:
        """Return a function of (state, phase, p) as a symbol."""
        return self._symbol(called(label, function, self.state, self.phase, self.p), label)

    def quantity(self, given: object, label: str) -> Symbol:
        """Return a number, the parameter of a name, or a function of (state, phase, p), as a symbol."""
        if isinstance(given, str):
            try:
                return getattr(self.p, given)
            except PageError as error:
                raise PageError(f"{label} = {given!r} is no parameter ({error})") from None
        return self.value(given, label) if callable(given) else self._symbol(given, label)

    def _symbol(self, value: object, label: str) -> Symbol:
        if isinstance(value, Symbol):
            return value
        with suppress(TypeError, ValueError):
            if isinstance(value, SupportsFloat):
                return constant(float(value))
        raise PageError(f"{label} is {value!r}; it must be one formula or number")

    def motion_with(self, forces: Mapping[int, Symbol]) -> list[Symbol]:
        """Return the rates of the states with these friction forces; switches have their signs."""
        given = {}
        for j, contact in enumerate(self.contacts):
            if isinstance(contact, DryFriction):
                given[contact.name] = forces[j]
            elif isinstance(contact, Switch):
                given[contact.name] = self.sign[j]
        rates = called(
            "motion", self.formulas_of_motion, self.state, self.phase, self.p, Named("contact", given)
        )
        if rates is None:
            raise PageError("motion returns nothing; return one rate per state, in their order")
        if not isinstance(rates, Sequence | np.ndarray):
            rates = (rates,)
        if len(rates) != len(self.states):
            raise PageError(
                f"motion returns {len(rates)} rate{'s' if len(rates) != 1 else ''} for {len(self.states)} states "
                f"({', '.join(self.states)}); return one rate per state, in their order"
            )
        in_si = [self._symbol(rate, f"motion's rate of {name}") for rate, name in zip(rates, self.states)]
        return [rate / self.factors.get(name, 1.0) for rate, name in zip(in_si, self.states)]

    def _in_si(self, name: str, value: Symbol) -> Symbol:
        """Return a parameter or state as the formulas receive it."""
        return value * self.factors.get(name, 1.0)

    def formulas(self) -> Iterator[tuple[str, str, int, Mapping[int, Symbol]]]:
        """Yield the formulas of each contact: description, kind of formula, contact, and this kind's formulas of all contacts."""
        kinds = ("gap", "restitution", "velocity", "limit", "surface")
        for j, contact in enumerate(self.contacts):
            for kind in kinds:
                if j in (table := getattr(self, kind)):
                    yield f"the {kind} of {contact.described}", kind, j, table

    # ------------------------------------------------------------------ derivatives
    def along(self, value: Symbol, rates: Sequence[Symbol]) -> Symbol:
        """Return the time derivative of a quantity along a flow."""
        variables = self.x if self.phase_rate is None else [*self.x, self.clock]
        (slopes,) = derivatives([value], variables)
        total = slopes[0] * rates[0]
        for slope, rate in zip(slopes[1:], rates[1:]):
            total = total + slope * rate
        return total if self.phase_rate is None else total + slopes[-1] * self.phase_rate

    def toward(self, value: Symbol, direction: Sequence[Symbol]) -> Symbol:
        """Return the derivative of a quantity in a direction of the states."""
        (slopes,) = derivatives([value], self.x)
        total = constant(0.0)
        for slope, part in zip(slopes, direction):
            total = total + slope * part
        return total

    def curvature(self, direction: Sequence[Symbol]) -> Symbol:
        """Return d . H d, with the Hessian H of the energy."""
        assert self.energy is not None
        return self.toward(self.toward(self.energy, direction), direction)

    def impact_mass(self, j: int) -> Symbol:
        """Return the mass of the relative motion at wall j."""
        turned = self.toward(self.gap_rate(j), self.push[j])
        return self.curvature(self.push[j]) / (turned * turned)

    def body_masses(self) -> dict[str, Symbol]:
        """Return, by name, speeds that a wall or a friction changes, with the mass that moves with each; empty without an energy."""
        found = {}
        for k, name in enumerate(self.states if self.energy is not None else ()):
            moved = self.without_forces.keys() & variables_of(self.rates[k])
            if moved or any(push[k].number != 0.0 for push in self.push.values()):
                unit = [constant(float(k == place)) for place in range(len(self.states))]
                found[name] = self.curvature(unit)
        return found

    def friction_effect(self, j: int) -> Symbol:
        """Return the contribution of a unit of friction j to the rate of its velocity."""
        (effect,) = derivatives([self.along(self.velocity[j], self.rates)], [self.force[j]])
        return effect[0]

    def gap_rate(self, j: int) -> Symbol:
        """Return the rate of a wall's gap; contact forces do not enter it (`checks` tests this)."""
        return self.along(self.gap[j], self.still)

    def impact(self, j: int, rest: bool = False) -> list[Symbol]:
        """Return the states after an impact on wall j: x + I d, with the impulse I that turns the gap's rate g into -e g (`rest`: into 0)."""
        impulse = self._impulse(j, rest)
        return [x + impulse * push for x, push in zip(self.x, self.push[j])]

    def deciding(self, j: int) -> frozenset[str]:
        """Return the names of the variables on which time and effect of an impact on wall j depend."""
        if j not in self._deciding:
            deciders = (self.gap[j], self._impulse(j, False), *self.push[j])
            self._deciding[j] = frozenset().union(*map(variables_of, deciders))
        return self._deciding[j]

    def _impulse(self, j: int, rest: bool) -> Symbol:
        """Return I = -(1 + e) g / (dg/dx . d), from g(x + I d) = g(x) + I (dg/dx . d)."""
        rate = self.gap_rate(j)
        effect = self.toward(rate, self.push[j])
        return -rate / effect if rest else -(1.0 + self.restitution[j]) * rate / effect

    def pattern(self, key: PatternKey) -> Pattern:
        """Return the flow while these frictions stick, these walls hold and these frictions are absent."""
        if key not in self._patterns:
            self._patterns[key] = Pattern(self, *key)
        return self._patterns[key]

    def pattern_key(self, modes: Sequence[int]) -> PatternKey:
        """Return the sticking frictions, holding walls and absent frictions of a mode (one entry per contact)."""
        kinds = list(enumerate(zip(self.contacts, modes)))
        friction = [(j, modes[j]) for j in self.velocity]
        return (
            tuple(j for j, m in friction if m == STUCK),
            tuple(j for j, (c, m) in kinds if isinstance(c, Wall) and m == HELD),
            tuple(j for j, m in friction if m == ABSENT),
        )

    def signs(self, modes: Sequence[int]) -> list[float]:
        """Return the runtime signs in a mode: 0 for a friction that sticks or is absent."""
        return [float(modes[j]) if modes[j] in (-1, 1) else 0.0 for j in self.signed]


def _solved(
    conditions: Sequence[Symbol], unknown: Mapping[int, Symbol]
) -> tuple[dict[int, Symbol], dict[int, Symbol]]:
    """Solve conditions that are affine in the unknown forces; return the forces, and the mobility of each.

    Cramer's rule by expansion, because there are only few at a time.
    """
    if not unknown:
        return {}, {}
    symbols = list(unknown.values())
    matrix = derivatives(list(conditions), symbols)
    zero = {name: 0.0 for s in symbols for name in variables_of(s)}
    rest = [replaced(c, zero) for c in conditions]
    whole = _determinant(matrix)
    forces, mobility = {}, {}
    for column, j in enumerate(unknown):
        changed = [
            [-rest[i] if k == column else entry for k, entry in enumerate(row)]
            for i, row in enumerate(matrix)
        ]
        forces[j] = _determinant(changed) / whole
        minor = [[v for c, v in enumerate(row) if c != column] for r, row in enumerate(matrix) if r != column]
        mobility[j] = whole / _determinant(minor) if minor else whole
    return forces, mobility


def _determinant(matrix: Sequence[Sequence[Symbol]]) -> Symbol:
    if len(matrix) == 1:
        return matrix[0][0]
    terms = [
        entry * _determinant([[v for c, v in enumerate(row) if c != k] for row in matrix[1:]])
        for k, entry in enumerate(matrix[0])
    ]
    total = terms[0]
    for k, term in enumerate(terms[1:], start=1):
        total = total - term if k % 2 else total + term
    return total
