"""Names, letters and numbers of a declared machine, before anything is traced; every refusal is a sentence that names the contact and the way out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.switch import Switch
from orbits.contacts.wall import Wall
from orbits.machines.page.formulas import PageError
from orbits.machines.page.si import OF_A_STATE


def check_names(
    name: object,
    states: Sequence[str],
    parameters: Mapping[str, Any],
    phase_rate: object,
    contacts: Sequence[Any],
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
        what = contact.described
        if isinstance(contact, DryFriction) and len(tuple(contact.letters)) != 3:
            raise PageError(
                f"{what}: letters = {contact.letters!r} must be three, for a turn, a stick and a slip"
            )
        if not isinstance(contact, Wall):
            if not str(contact.name).isidentifier():
                raise PageError(f"{what}: the name must be one that contact.<name> can have")
            if contact.name in named:
                raise PageError(f"{named[contact.name]} and {what} share a name; give one of them another")
            named[contact.name] = what
        for letter in contact.letters:
            if not isinstance(letter, str) or not letter or any(c in " []" or c.isspace() for c in letter):
                raise PageError(f"{what}: {letter!r} is no letter of a word; use letters and digits")
            if letter in taken:
                hint = " (letters=('t2', 's2', 'u2'))" if isinstance(contact, DryFriction) else ""
                raise PageError(
                    f"{taken[letter]} and {what} share the letter {letter!r}; give one of them another{hint}"
                )
            taken[letter] = what
        if isinstance(contact, Wall):
            _check_wall(what, states, contact)


def _check_wall(what: str, states: Sequence[str], contact: Wall) -> None:
    if not isinstance(contact.push, Mapping):
        raise PageError(
            f"{what}: push = {contact.push!r} must say how an impulse changes the states by name, for example "
            f"{{{states[-1]!r}: -1.0}}"
        )
    unknown = [k for k in contact.push if k not in states]
    if unknown or not contact.push:
        raise PageError(
            f"{what}: push names {unknown[0] if unknown else 'nothing'!r}; "
            f"say how an impulse changes the states, of {', '.join(states)}"
        )
    if isinstance(contact.restitution, str):
        return
    if not isinstance(contact.restitution, Real):
        raise PageError(
            f"{what}: restitution = {contact.restitution!r} must be a number or the name of a parameter"
        )
    check_restitution(what, float(contact.restitution))


def check_restitution(what: str, value: float) -> None:
    """Newton's coefficient."""
    if not 0.0 < value <= 1.0:
        raise PageError(
            f"{what}: restitution = {value:g} is out of range; give a number above 0 and at most 1"
        )


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


def check_response(response: str | None, states: Sequence[str], contacts: Sequence[Any]) -> None:
    """Refuse a response that orbits or simulations do not tell.

    Raises
    ------
    PageError
        If it is none of the known names.
    """
    walls = any(isinstance(contact, Wall) for contact in contacts)
    known = [*(f"{kind}_{states[0]}" for kind in OF_A_STATE[:3]), *(["approach_speed"] if walls else [])]
    if response is not None and response not in known:
        raise PageError(f"response = {response!r}: expected {', '.join(known)}")
