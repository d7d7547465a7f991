"""What a page is asked before it becomes a machine; every refusal is a sentence that names the contact and the way out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import Wall
from orbits.declared import engine
from orbits.declared.equations import Equations
from orbits.declared.formulas import PageError

DRAWS = 8  # random states at which formulas are compared
SAME = 1e-9  # relative


def check_names(
    name: Any, states: Sequence[str], parameters: Mapping[str, Any], phase_rate: Any, contacts: Sequence[Any]
) -> None:
    """Names, numbers and letters, before anything is traced."""
    if not (isinstance(name, str) and name.isidentifier()):
        raise PageError(
            f"name = {name!r} must be a word of letters, digits and underscores, for example 'stop'"
        )
    if isinstance(states, str) or not states:
        raise PageError(f"states = {states!r} must be a sequence of names, for example ('x', 'v')")
    for what, names in (("states", list(states)), ("parameters", list(parameters))):
        for item in names:
            if not (isinstance(item, str) and item.isidentifier()):
                raise PageError(f"{what}: {item!r} is no name; use letters, digits and underscores")
        if len(set(names)) != len(names):
            raise PageError(f"{what} = {names!r} has a name twice")
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
    if not len(contacts):
        raise PageError(
            "contacts = []: give at least one Wall, DryFriction or Switch; without any there are no events that a word could name"
        )
    taken: dict[str, str] = {}
    for contact in contacts:
        if not isinstance(contact, (Wall, DryFriction, Switch)):
            raise PageError(f"contacts has {contact!r}; it may have Wall, DryFriction and Switch")
        what = described(contact)
        if isinstance(contact, DryFriction) and len(tuple(contact.letters)) != 3:
            raise PageError(
                f"{what}: letters = {contact.letters!r} must be three, for a turn, a stick and a slip"
            )
        if not isinstance(contact, Wall) and not str(contact.name).isidentifier():
            raise PageError(f"{what}: the name must be one that contact.<name> can have")
        for letter in contact.letters:
            if not letter or any(c in " []" or c.isspace() for c in letter):
                raise PageError(f"{what}: {letter!r} is no letter of a word; use letters and digits")
            if letter in taken:
                hint = " (letters=('t2', 's2', 'u2'))" if isinstance(contact, DryFriction) else ""
                raise PageError(
                    f"{taken[letter]} and {what} share the letter {letter!r}; give one of them another{hint}"
                )
            taken[letter] = what
        if isinstance(contact, Wall):
            unknown = [k for k in contact.push if k not in states]
            if unknown or not contact.push:
                raise PageError(
                    f"{what}: push names {unknown[0] if unknown else 'nothing'!r}; "
                    f"say how an impulse changes the states, of {', '.join(states)}"
                )
            if not isinstance(contact.restitution, str):
                check_restitution(what, float(contact.restitution))


def check_restitution(what: str, value: float) -> None:
    """Newton's coefficient."""
    if not 0.0 < value <= 1.0:
        raise PageError(
            f"{what}: restitution = {value:g} is out of range; give a number above 0 and at most 1"
        )


def described(contact: Any) -> str:
    """A contact as sentences name it."""
    if isinstance(contact, Wall):
        return f"wall {contact.letter!r}"
    return f"{'friction' if isinstance(contact, DryFriction) else 'switch'} {contact.name!r}"


class Draws:
    """Random states, phases and signs beside the machine's own parameters."""

    def __init__(self, equations: Equations, params: np.ndarray) -> None:
        generator = np.random.default_rng(14)
        self.equations = equations
        self.states = generator.uniform(-1.0, 1.0, (DRAWS, len(equations.states)))
        self.clock = generator.uniform(0.0, 2.0 * np.pi, DRAWS)
        self.signs = generator.choice([-1.0, 1.0], (DRAWS, len(equations.signed)))
        self.params = np.tile(params, (DRAWS, 1))

    def of(
        self, values: Sequence[Any], states: Any = None, clock: Any = None, signs: Any = None
    ) -> np.ndarray:
        """Values, shape (DRAWS, count)."""
        numbers = np.hstack([self.params, self.signs if signs is None else signs])
        with np.errstate(all="ignore"):
            return engine.Values(self.equations.layout, list(values))(
                self.states if states is None else states, self.clock if clock is None else clock, numbers
            )


def check_contacts(equations: Equations, params: np.ndarray) -> dict[tuple[int, int], int | None]:
    """Walls, frictions and switches against the motion; returns what impacts do to frictions and switches (`Alphabet.flips`)."""
    e, draws = equations, Draws(equations, params)
    flips: dict[tuple[int, int], int | None] = {}
    frictions = [j for j, c in enumerate(e.contacts) if isinstance(c, DryFriction)]
    force = {j: engine.variable(f"force_{e.contacts[j].name}") for j in frictions}
    rates = e.motion_with(force)
    zero = {f"force_{e.contacts[j].name}": 0.0 for j in frictions}
    for j in frictions:
        what = described(e.contacts[j])
        name = f"force_{e.contacts[j].name}"
        (effect,) = engine.derivatives([e.along(e.velocity[j], rates)], [force[j]])
        others = {n for n in zero if n != name}
        if not any(name in engine.variables_of(rate) for rate in rates):
            raise PageError(
                f"{what}: motion ignores contact.{e.contacts[j].name}; add the force to the rate of a velocity it acts on"
            )
        if name in engine.variables_of(effect[0]) | _inside(rates, name):
            raise PageError(
                f"{what}: motion must be affine in contact.{e.contacts[j].name} (force times a mass factor)"
            )
        sizes = draws.of([engine.replaced(effect[0], dict.fromkeys(others | {name}, 0.0))])[:, 0]
        if not np.all(sizes[np.isfinite(sizes)] > 1e-12):
            raise PageError(
                f"{what}: a positive contact.{e.contacts[j].name} must speed its velocity up; here it gives the acceleration "
                f"{float(np.nanmin(sizes)):.3g}. Change the sign of the force in motion, or of the velocity"
            )
    for j, contact in enumerate(e.contacts):
        if not isinstance(contact, Wall):
            continue
        what = described(contact)
        rate = e.along(e.gap[j], rates)
        if any(name in engine.variables_of(rate) for name in zero):
            raise PageError(
                f"{what}: the rate of its gap contains a friction force; a gap is a distance, not a velocity"
            )
        after = e.impact(j)
        (effects,) = engine.derivatives([rate], e.x)
        moved: Any = 0.0
        for effect, push in zip(effects, e.push[j]):
            moved = effect * push + moved
        sizes = draws.of([moved])[:, 0]
        if not np.all(np.abs(sizes[np.isfinite(sizes)]) > 1e-12):
            raise PageError(
                f"{what}: an impulse along push = {dict(contact.push)!r} does not change the rate of its gap; "
                "push the velocities of the bodies that meet there"
            )
        table = draws.of([e.gap_rate(j), e.restitution[j], e.gap[j], *after])
        later = draws.of([e.gap_rate(j), e.gap[j]], states=table[:, 3:])
        if np.abs(later[:, 1] - table[:, 2]).max() > SAME * (1.0 + np.abs(table[:, 2]).max()):
            raise PageError(f"{what}: the impulse moves the gap itself; push rates of positions only")
        if np.abs(later[:, 0] + table[:, 1] * table[:, 0]).max() > SAME * (1.0 + np.abs(table[:, 0]).max()):
            raise PageError(f"{what}: the rate of its gap must be linear in what push changes")
        for k in e.signed:
            flip = _flip(draws, e.velocity[k] if k in e.velocity else e.surface[k], table)
            if flip != 0:
                flips[j, k] = flip
    return flips


def riding(equations: Equations, params: np.ndarray) -> frozenset[tuple[int, int]]:
    """Switches whose surface moves with the velocity of a friction (`Alphabet.rides`): its rate is that velocity times a number."""
    e, draws = equations, Draws(equations, params)
    force = {j: engine.variable(f"force_{e.contacts[j].name}") for j in e.velocity}
    rates = e.motion_with(force)
    found = set()
    for j, surface in e.surface.items():
        rate = e.along(surface, rates)
        if any(name in engine.variables_of(rate) for f in force.values() for name in engine.variables_of(f)):
            continue
        for k, velocity in e.velocity.items():
            table = draws.of([rate, velocity])
            ratio = table[:, 0] / table[:, 1]
            if np.all(np.isfinite(ratio)) and np.ptp(ratio) < SAME * np.abs(ratio).max():
                found.add((j, k))
    return frozenset(found)


def _inside(rates: Sequence[Any], name: str) -> set[str]:
    """The name, if the rates are not affine in it."""
    slopes = engine.derivatives(list(rates), [engine.variable(name)])
    return {name} & set().union(*(engine.variables_of(row[0]) for row in slopes))


def _flip(draws: Draws, value: Any, table: np.ndarray) -> int | None:
    """0: the impact leaves the velocity (or surface) alone; -1, +1: its sign afterwards; None: it may change to either."""
    before = draws.of([value])[:, 0]
    after = draws.of([value], states=table[:, 3:])[:, 0]
    if np.abs(after - before).max() < SAME * (1.0 + np.abs(before).max()):
        return 0
    ratio = before / table[:, 0]  # velocity = ratio * rate of the gap, everywhere
    if np.all(np.isfinite(ratio)) and np.ptp(ratio) < SAME * np.abs(ratio).max():
        return 1 if ratio[0] > 0.0 else -1  # after the impact the gap opens
    return None


def check_mirror(
    equations: Equations, params: np.ndarray, pairs: Mapping[str, str]
) -> tuple[dict[int, int], frozenset[int]]:
    """Whether the mirror image of every motion is one: all states change sign, half a forcing period on.

    Returns
    -------
    images : dict of int to int
        Contact -> its mirror image.
    turned : frozenset of int
        Switches whose sign turns.
    """
    e, draws = equations, Draws(equations, params)
    by_letter = {letter: j for j, c in enumerate(e.contacts) for letter in (c.name, *c.letters)}
    images = {j: j for j in range(len(e.contacts))}
    for one, other in pairs.items():
        for letter in (one, other):
            if letter not in by_letter:
                raise PageError(
                    f"mirror = {dict(pairs)!r}: {letter!r} is no contact; there are {', '.join(by_letter)}"
                )
        a, b = by_letter[one], by_letter[other]
        if type(e.contacts[a]) is not type(e.contacts[b]):
            raise PageError(f"mirror: {one!r} and {other!r} are contacts of different kinds")
        images[a], images[b] = b, a
    on = draws.clock + np.pi
    turned = set()

    def compare(what: str, here: np.ndarray, there: np.ndarray) -> None:
        gap = np.abs(here - there)
        if not np.nanmax(gap) <= SAME * (1.0 + np.nanmax(np.abs(here))):
            k = int(np.nanargmax(gap))
            state = ", ".join(f"{n} = {v:.4g}" for n, v in zip(e.states, draws.states[k]))
            when = f", phase = {draws.clock[k]:.4g}" if e.phase_rate is not None else ""
            raise PageError(
                f"mirror: {what} is not the mirror image: at {state}{when} it is {float(np.ravel(here)[k]):.6g}, its image gives "
                f"{float(np.ravel(there)[k]):.6g}; set mirror=None, or correct the formula"
            )

    for j, contact in enumerate(e.contacts):
        what, k = described(contact), images[j]
        if isinstance(contact, Wall):
            here = draws.of([e.gap[j], e.restitution[j]])
            there = draws.of([e.gap[k], e.restitution[k]], states=-draws.states, clock=on)
            compare(f"the gap of {what}", here[:, 0], there[:, 0])
            compare(f"the restitution of {what}", here[:, 1], there[:, 1])
        elif isinstance(contact, DryFriction):
            here = draws.of([e.velocity[j], e.limit[j]])
            there = draws.of([e.velocity[k], e.limit[k]], states=-draws.states, clock=on)
            compare(f"the velocity of {what}", here[:, 0], -there[:, 0])
            compare(f"the limit of {what}", here[:, 1], there[:, 1])
        else:
            here = draws.of([e.surface[j]])[:, 0]
            there = draws.of([e.surface[k]], states=-draws.states, clock=on)[:, 0]
            if np.abs(here + there).max() < np.abs(here - there).max():
                turned.add(j)
                there = -there
            compare(f"the surface of {what}", here, there)
    signs = np.empty_like(draws.signs)
    for place, j in enumerate(e.signed):
        turns = isinstance(e.contacts[j], DryFriction) or j in turned
        signs[:, e.signed.index(images[j])] = draws.signs[:, place] * (-1.0 if turns else 1.0)
    rates = e.pattern(e.pattern_key([1 if j in e.signed else 0 for j in range(len(e.contacts))])).rates
    here = draws.of(rates)
    there = draws.of(rates, states=-draws.states, clock=on, signs=signs)
    for i, name in enumerate(e.states):
        compare(f"motion's rate of {name}", here[:, i], -there[:, i])
    return images, frozenset(turned)


def check_starts(
    starts: Mapping[str, tuple[float, float]] | None, states: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Ranges of starts as numbers.

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
