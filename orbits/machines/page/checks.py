"""Checks of a declared machine's formulas; every error message names the contact and the remedy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values, derivatives, replaced, variables_of
from orbits.machines.page.page import PageError
from orbits.machines.page.patterns import Equations
from orbits.machines.page.si import OF_A_STATE
from orbits.settings import FORMULAS

if TYPE_CHECKING:
    from orbits.symbols import Symbol


DRAWS = 8  # random states at which formulas are compared


class Draws:
    """Random states, phases and signs, together with parameters."""

    def __init__(self, equations: Equations, params: np.ndarray) -> None:
        generator = np.random.default_rng(14)
        self.equations = equations
        self.states = generator.uniform(-1.0, 1.0, (DRAWS, len(equations.states)))
        self.clock = generator.uniform(0.0, 2.0 * np.pi, DRAWS)
        self.signs = generator.choice([-1.0, 1.0], (DRAWS, len(equations.signed)))
        self.params = np.tile(params, (DRAWS, 1))

    @classmethod
    def elsewhere(cls, equations: Equations, params: np.ndarray) -> Draws:
        """Draws at parameters near the given ones, none of which is zero; at the given ones if a formula has no value there.

        A relation between contacts must hold at all parameters: a wall whose amplitude is zero by default moves at others.
        """
        e = equations
        parts = np.random.default_rng(15).uniform(0.1, 0.5, len(params))
        draws = cls(e, np.where(params == 0.0, parts, (1.0 + parts) * params))
        formulas = [*e.velocity.values(), *e.surface.values()]
        formulas += [value for j in e.gap for value in (e.gap_rate(j), *e.impact(j))]
        return draws if np.isfinite(draws.of(formulas)).all() else cls(e, params)

    def of(
        self,
        values: Sequence[Any],
        states: np.ndarray | None = None,
        clock: np.ndarray | None = None,
        signs: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return values, shape (DRAWS, count)."""
        numbers = np.hstack([self.params, self.signs if signs is None else signs])
        with np.errstate(all="ignore"):
            return Values(self.equations.layout, list(values))(
                self.states if states is None else states, self.clock if clock is None else clock, numbers
            )


def check_contacts(equations: Equations, params: np.ndarray) -> dict[tuple[int, int], int | None]:
    """Check walls, frictions and switches against the motion; return the effect of impacts on signs (`Alphabet.flips`)."""
    e, draws, others = equations, Draws(equations, params), Draws.elsewhere(equations, params)
    flips: dict[tuple[int, int], int | None] = {}
    _check_periods(draws)
    _check_surfaces(others)
    for j, force in e.force.items():
        label = e.contacts[j].described
        limit = draws.of([e.limit[j]])[:, 0]
        if np.all(limit < 0.0):
            raise PageError(f"{label}: the limit is {limit[0]:.4g}; give the largest force, 0 or above")
        effect = e.friction_effect(j)
        (name,) = variables_of(force)
        if not any(name in variables_of(rate) for rate in e.rates):
            raise PageError(
                f"{label}: motion ignores contact.{e.contacts[j].name}; add the force to the rate of a velocity it acts on"
            )
        slopes = [row[0] for row in derivatives(e.rates, [force])]
        if any(name in variables_of(slope) for slope in (effect, *slopes)):
            raise PageError(
                f"{label}: motion must be affine in contact.{e.contacts[j].name} (force times a mass factor)"
            )
        sizes = draws.of([replaced(effect, e.without_forces)])[:, 0]
        if not np.all(sizes[np.isfinite(sizes)] > FORMULAS.zero):
            raise PageError(
                f"{label}: a positive contact.{e.contacts[j].name} must speed its velocity up; here it gives the acceleration "
                f"{float(np.nanmin(sizes)):.3g}. Change the sign of the force in motion, or of the velocity"
            )
    for j, contact in enumerate(e.contacts):
        if not isinstance(contact, Wall):
            continue
        label = contact.described
        rate = e.along(e.gap[j], e.rates)
        if e.without_forces.keys() & variables_of(rate):
            raise PageError(
                f"{label}: the rate of its gap contains a friction force; a gap is a distance, not a velocity"
            )
        after = e.impact(j)
        sizes = draws.of([e.toward(rate, e.push[j])])[:, 0]
        if not np.all(np.abs(sizes[np.isfinite(sizes)]) > FORMULAS.zero):
            raise PageError(
                f"{label}: an impulse along push = {dict(contact.push)!r} does not change the rate of its gap; "
                "push the velocities of the bodies that meet there"
            )
        table = draws.of([e.gap_rate(j), e.restitution[j], e.gap[j], *after])
        after_impulse = draws.of([e.gap_rate(j), e.gap[j]], states=table[:, 3:])
        if np.abs(after_impulse[:, 1] - table[:, 2]).max() > FORMULAS.same * (
            1.0 + np.abs(table[:, 2]).max()
        ):
            raise PageError(f"{label}: the impulse moves the gap itself; push rates of positions only")
        if np.abs(after_impulse[:, 0] + table[:, 1] * table[:, 0]).max() > FORMULAS.same * (
            1.0 + np.abs(table[:, 0]).max()
        ):
            raise PageError(f"{label}: the rate of its gap must be linear in what push changes")
        for k in e.signed:
            flip = _flip(others, j, e.velocity[k] if k in e.velocity else e.surface[k])
            if flip != 0:
                flips[j, k] = flip
    return flips


def _check_periods(draws: Draws) -> None:
    """Check that all formulas have the period 2 pi in the phase."""
    e = draws.equations
    if e.phase_rate is None:
        return
    formulas = [(f"motion's rate of {n}", replaced(r, e.without_forces)) for n, r in zip(e.states, e.rates)]
    formulas += [(name, table[j]) for name, _, j, table in e.formulas()]
    values = [value for _, value in formulas]
    first, second = draws.of(values), draws.of(values, clock=draws.clock + 2.0 * np.pi)
    for (label, _), a, b in zip(formulas, first.T, second.T):
        with np.errstate(invalid="ignore"):
            gap = np.abs(a - b)
        if np.nanmax(gap, initial=0.0) > FORMULAS.same * (1.0 + np.nanmax(np.abs(a), initial=0.0)):
            k = int(np.nanargmax(gap))
            raise PageError(
                f"{label} does not have the period 2 pi in the phase: at phase = {draws.clock[k]:.4g} it is {a[k]:.6g}, 2 pi later "
                f"{b[k]:.6g}; let phase_rate be the lowest frequency of the forcing, and write the others as whole multiples of the phase"
            )


def _check_surfaces(draws: Draws) -> None:
    """Check that switches affect the motion, and that no two contacts always act together."""
    e = draws.equations
    for j, surface in e.surface.items():
        label, name = e.contacts[j].described, e.contacts[j].name
        if not variables_of(surface) & {*e.layout.states, e.layout.clock}:
            raise PageError(
                f"{label}: its surface is a constant; give a function of the states that changes sign"
            )
        used = set().union(*(variables_of(v) for v in (*e.rates, *e.limit.values())))
        if not variables_of(e.sign[j]) & used:
            raise PageError(
                f"{label}: motion ignores contact.{name}; use it where the law changes, or leave the switch out"
            )
    pairs = [*e.velocity.items(), *e.surface.items()]
    for place, (j, one) in enumerate(pairs):
        for k, other in pairs[place + 1 :]:
            if j not in e.velocity or not _proportional(draws, one, other):
                continue
            pair = f"{e.contacts[j].described} and {e.contacts[k].described}"
            if k in e.velocity:
                raise PageError(
                    f"{pair} have the same velocity; declare one DryFriction whose limit is the sum of theirs"
                )
            raise PageError(
                f"{pair} change together; leave the switch out: what turns with the velocity belongs into the friction's limit, "
                "for example limit=lambda state, phase, p: p.friction + p.drag * state.v**2"
            )


def _proportional(draws: Draws, one: Symbol, other: Symbol) -> bool:
    """Return whether two quantities differ only by a constant factor."""
    table = draws.of([one, other])
    with np.errstate(all="ignore"):
        ratio = table[:, 0] / table[:, 1]
    return bool(
        np.all(np.isfinite(ratio)) and np.any(ratio) and np.ptp(ratio) < FORMULAS.same * np.abs(ratio).max()
    )


def riding(equations: Equations, params: np.ndarray) -> frozenset[tuple[int, int]]:
    """Return the switches whose surface moves with the velocity of a friction (`Alphabet.rides`): its rate is that velocity times a number."""
    e, draws = equations, Draws.elsewhere(equations, params)
    found = set()
    for j, surface in e.surface.items():
        rate = e.along(surface, e.rates)
        if e.without_forces.keys() & variables_of(rate):
            continue
        for k, velocity in e.velocity.items():
            if _proportional(draws, rate, velocity):
                found.add((j, k))
    return frozenset(found)


def _flip(draws: Draws, wall: int, value: Symbol) -> int | None:
    """Return 0 if the impact does not change the velocity (or surface); -1 or +1, its sign afterwards; None if both signs are possible."""
    e = draws.equations
    table = draws.of([value, e.gap_rate(wall), *e.impact(wall)])
    before, rate, after = table[:, 0], table[:, 1], draws.of([value], states=table[:, 2:])[:, 0]
    if np.abs(after - before).max() < FORMULAS.same * (1.0 + np.abs(before).max()):
        return 0
    with np.errstate(all="ignore"):
        ratio = before / rate  # constant if velocity = ratio * rate of the gap everywhere
    if np.all(np.isfinite(ratio)) and np.ptp(ratio) < FORMULAS.same * np.abs(ratio).max():
        return 1 if ratio[0] > 0.0 else -1  # after the impact the gap opens
    return None


def check_names(
    name: object,
    states: Sequence[str],
    parameters: Mapping[str, Any],
    phase_rate: object,
    contacts: Sequence[Any],
) -> None:
    """Check names, numbers and letters, before any formula is evaluated."""
    if not (isinstance(name, str) and name.isidentifier()):
        raise PageError(
            f"name = {name!r} must be a word of letters, digits and underscores, for example 'stop'"
        )
    if isinstance(states, str) or not states:
        raise PageError(f"states = {states!r} must be a sequence of names, for example ('x', 'v')")
    for field, names in (("states", list(states)), ("parameters", list(parameters))):
        for item in names:
            if not (isinstance(item, str) and item.isidentifier()):
                raise PageError(f"{field}: {item!r} is no name; use letters, digits and underscores")
        if len(set(names)) != len(names):
            raise PageError(f"{field} = {names!r} has a name twice")
    for item, value in parameters.items():
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise PageError(f"parameters: {item} = {value!r} is not a number") from None
        if not math.isfinite(number):
            raise PageError(f"parameters: {item} = {number} is not finite")
    if phase_rate is not None and phase_rate not in parameters:
        raise PageError(
            f"phase_rate = {phase_rate!r} is no parameter; name the forcing's frequency, one of "
            f"{', '.join(parameters) or 'none'}, or leave it out for a self-excited machine"
        )
    for item in (*states, *parameters):
        if item == "phase":
            raise PageError(
                "phase is the name of the forcing's phase; give the state or parameter of this name another one"
            )
        if item in states and item in parameters:
            raise PageError(f"{item!r} is a state and a parameter; give one of them another name")
    _check_contacts(states, contacts)


def _check_contacts(states: Sequence[str], contacts: Sequence[Any]) -> None:
    if isinstance(contacts, str) or not isinstance(contacts, Sequence):
        raise PageError(f"contacts = {contacts!r} must be a list, for example [Wall(...)]")
    taken: dict[str, str] = {}
    named: dict[str, str] = {}
    for contact in contacts:
        if not isinstance(contact, (Wall, DryFriction, Switch)):
            raise PageError(f"contacts has {contact!r}; it may have Wall, DryFriction and Switch")
        label = contact.described
        if isinstance(contact, DryFriction) and len(tuple(contact.letters)) != 3:
            raise PageError(
                f"{label}: letters = {contact.letters!r} must be three, for a turn, a stick and a slip"
            )
        if not isinstance(contact, Wall):
            if not str(contact.name).isidentifier():
                raise PageError(f"{label}: the name must be one that contact.<name> can have")
            if contact.name in named:
                raise PageError(f"{named[contact.name]} and {label} share a name; give one of them another")
            named[contact.name] = label
        for letter in contact.letters:
            if not isinstance(letter, str) or not letter or any(c in " []" or c.isspace() for c in letter):
                raise PageError(f"{label}: {letter!r} is no letter of a word; use letters and digits")
            if letter in taken:
                hint = " (letters=('t2', 's2', 'u2'))" if isinstance(contact, DryFriction) else ""
                raise PageError(
                    f"{taken[letter]} and {label} share the letter {letter!r}; give one of them another{hint}"
                )
            taken[letter] = label
        if isinstance(contact, Wall):
            _check_wall(label, states, contact)


def _check_wall(label: str, states: Sequence[str], contact: Wall) -> None:
    if not isinstance(contact.push, Mapping):
        raise PageError(
            f"{label}: push = {contact.push!r} must say how an impulse changes the states by name, for example "
            f"{{{states[-1]!r}: -1.0}}"
        )
    unknown = [k for k in contact.push if k not in states]
    if unknown or not contact.push:
        raise PageError(
            f"{label}: push names {unknown[0] if unknown else 'nothing'!r}; "
            f"say how an impulse changes the states, of {', '.join(states)}"
        )
    if isinstance(contact.restitution, str):
        return
    if not isinstance(contact.restitution, Real):
        raise PageError(
            f"{label}: restitution = {contact.restitution!r} must be a number or the name of a parameter"
        )
    check_restitution(label, float(contact.restitution))


def check_restitution(label: str, value: float) -> None:
    """Check Newton's coefficient."""
    if not 0.0 < value <= 1.0:
        raise PageError(
            f"{label}: restitution = {value:g} is out of range; give a number above 0 and at most 1"
        )


def check_starts(
    starts: Mapping[str, tuple[float, float]] | None, states: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Return ranges of starts as numbers.

    Raises
    ------
    PageError
        If a state is unknown or a range no interval.
    """
    ranges = {}
    for name, limits in dict(starts or {}).items():
        if name not in states:
            raise PageError(f"starts: {name!r} is no state; the machine has {', '.join(states)}")
        try:
            low, high = map(float, limits)
        except (TypeError, ValueError):
            raise PageError(f"starts: {name} = {limits!r}; give two numbers (low, high)") from None
        if not (np.isfinite(low) and np.isfinite(high) and low < high):
            raise PageError(
                f"starts: {name} = ({low:g}, {high:g}) is no interval; give the lower number first"
            )
        ranges[name] = (low, high)
    return ranges


def check_response(response: str | None, states: Sequence[str], contacts: Sequence[Any]) -> None:
    """Check the name of the response.

    Raises
    ------
    PageError
        If it is none of the measures that both orbits and simulations have.
    """
    walls = any(isinstance(contact, Wall) for contact in contacts)
    choices = [*(f"{kind}_{states[0]}" for kind in OF_A_STATE[:3]), *(["approach_speed"] if walls else [])]
    if response is not None and response not in choices:
        raise PageError(f"response = {response!r}: expected {', '.join(choices)}")


def check_energy(e: Equations, params: np.ndarray, wall: int) -> None:
    """Check that a wall's push moves a mass in the energy.

    Raises
    ------
    PageError
    """
    values = Draws(e, params).of([e.impact_mass(wall)])[:, 0]
    if not np.all(values > 0.0):
        raise PageError(
            f"energy: the push of {e.contacts[wall].described} moves a mass of {values.min():.4g}; give the energy of all bodies, "
            "their kinetic energies among it, in joules"
        )
