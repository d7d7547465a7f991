"""What is no number at a state: which formula of a declared machine divides by zero there, and on which of its lines."""

from __future__ import annotations

import linecache
import os
import traceback
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values, derivatives
from orbits.machines.page.formulas import Named, States
from orbits.machines.page.patterns import Equations
from orbits.settings import FORMULAS

HERE = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
FAILS = {"divide": "a division by zero", "invalid": "no number"}


def singular_at(
    equations: Equations, params: np.ndarray, modes: Sequence[int], state: np.ndarray, clock: float
) -> str:
    """A sentence's part: the formula that is no number at a state or has no slopes there, and the state; empty if all are fine."""
    if not np.abs(state).max() < FORMULAS.runaway:
        return ""
    at = ", ".join(f"{name} = {value:.6g}" for name, value in zip(equations.states, state))
    if equations.phase_rate is not None:
        at += f", phase = {clock:.6g}"
    for what, formula in _on_numbers(equations, params, modes, state, clock):
        with np.errstate(divide="raise", invalid="raise", over="ignore"):
            try:
                formula()
            except (ArithmeticError, ValueError) as error:
                return f"{what} has {_named(error)}{_line(error)} at {at}"
    for what, symbols in _on_symbols(equations, modes):
        numbers = np.concatenate([params, equations.signs(modes)])
        slopes = [slope for row in derivatives(symbols, equations.x) for slope in row]
        if not np.isfinite(Values(equations.layout, slopes).one(state, clock, numbers)).all():
            return f"{what} has no slopes (a root of zero, or the like) at {at}"
    return ""


def _on_numbers(
    e: Equations, params: np.ndarray, modes: Sequence[int], state: np.ndarray, clock: float
) -> Iterator[tuple[str, Callable]]:
    """What each formula of the page is, and its call with numbers in place of symbols."""
    names = [name.removeprefix("p_") for name in e.layout.numbers[: len(params)]]
    si = e.factors
    p = Named("p", {name: np.float64(value) * si.get(name, 1.0) for name, value in zip(names, params)})
    x = [np.float64(x) * si.get(name, 1.0) for name, x in zip(e.states, state)]
    arguments = States(e.states, x), e.phase, p
    if e.phase_rate is not None:
        arguments = (arguments[0], np.float64(clock), p)
    forces = {}
    for j, contact in enumerate(e.contacts):
        if not isinstance(contact, Wall):
            forces[contact.name] = np.float64(0.0 if isinstance(contact, DryFriction) else modes[j])
    yield "motion", lambda: e.formulas_of_motion(*arguments, Named("contact", forces))
    for contact in e.contacts:
        if isinstance(contact, Wall):
            given = {"the gap": contact.gap, **{f"the push on {k}": v for k, v in contact.push.items()}}
            given["the restitution"] = contact.restitution
        elif isinstance(contact, DryFriction):
            given = {"the velocity": contact.velocity, "the limit": contact.limit}
        else:
            given = {"the surface": contact.surface}
        for what, function in given.items():
            if callable(function):
                yield f"{what} of {contact.described}", lambda f=function: f(*arguments)


def _on_symbols(e: Equations, modes: Sequence[int]) -> Iterator[tuple[str, list[Any]]]:
    yield "motion", e.pattern(e.pattern_key(modes)).rates
    for what, symbols in (("gap", e.gap), ("velocity", e.velocity), ("surface", e.surface)):
        for j, symbol in symbols.items():
            yield f"the {what} of {e.contacts[j].described}", [symbol]


def _named(error: Exception) -> str:
    text = str(error)
    if isinstance(error, ZeroDivisionError):
        return FAILS["divide"]
    return next((said for word, said in FAILS.items() if word in text), text)


def _line(error: Exception) -> str:
    """The last line of the page that was being worked out, as far as its text is known."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not f.filename.startswith(HERE)]
    if not frames or frames[-1].lineno is None:
        return ""
    text = linecache.getline(frames[-1].filename, frames[-1].lineno).strip()
    return f" (line {frames[-1].lineno} of the machine file: {text})" if text else ""
