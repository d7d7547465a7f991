"""Impossible parameter values of a declared machine, and states at which its formulas are undefined.

Impossible are walls that overlap, masses that are not positive, restitutions out of range, friction that accelerates, divisions by zero. The
formulas are evaluated at random states; a value is impossible if the demand fails at all of them. For an undefined formula the line of the
machine file is given.
"""

from __future__ import annotations

import linecache
import os
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from orbits.contacts.dry_friction import DryFriction
from orbits.contacts.wall import Wall
from orbits.integrators.expressions import Values, derivatives, replaced, variable, variables_of
from orbits.machines.page.checks import Draws
from orbits.machines.page.page import Named, States
from orbits.machines.page.patterns import Equations
from orbits.machines.page.si import CONTACT
from orbits.settings import FORMULAS
from orbits.symbols import Symbol

SHOWN = 4  # largest number of parameters named in a sentence


@dataclass(frozen=True)
class Demand:
    """A formula of the machine, and the condition for its values.

    Attributes
    ----------
    value : Symbol
    holds : callable
        Values at random states -> bool array: which are possible.
    rule : str
        The condition in words, to follow "is out of range: ".
    """

    value: Symbol
    holds: Callable[[np.ndarray], np.ndarray]
    rule: str

    @property
    def parameters(self) -> frozenset[str]:
        """Names of the parameters on which the formula depends."""
        return frozenset(n.removeprefix("p_") for n in variables_of(self.value) if n.startswith("p_"))


class Possible:
    """The conditions that the parameters of a machine must satisfy.

    Parameters
    ----------
    equations : Equations
    units : mapping of str to str
        Units of the parameters, by name.
    """

    def __init__(self, equations: Equations, units: Mapping[str, str]) -> None:
        self.equations, self.units = equations, units
        self.names = [name.removeprefix("p_") for name in equations.layout.numbers if name.startswith("p_")]
        self.demands = [
            *_gap_demands(equations, units),
            *_masses(equations),
            *_rates(equations),
            *_contacts(equations),
        ]
        if CONTACT in self.names:
            self.demands.append(Demand(variable(f"p_{CONTACT}"), _open, "an impact lasts longer than 0"))
        self._asked: dict[str | None, tuple[list[Demand], Values]] = {}
        self._passed = b""  # the last parameter vector that was tested and is possible

    def wrong(self, params: np.ndarray, single: str | None = None) -> str:
        """Return a sentence on the first demand that is not met; empty if all are.

        Parameters
        ----------
        params : float array (P,)
        single : str, optional
            Test only demands that depend on this parameter alone.
        """
        if single is None and params.tobytes() == self._passed:
            return ""
        if single not in self._asked:
            demands = [one for one in self.demands if single is None or one.parameters == {single}]
            self._asked[single] = demands, Values(self.equations.layout, [one.value for one in demands])
        demands, formulas = self._asked[single]
        if not demands:
            return ""
        draws = Draws(self.equations, params)
        with np.errstate(all="ignore"):
            table = formulas(draws.states, draws.clock, np.hstack([draws.params, draws.signs]))
        for demand, values in zip(demands, table.T):
            if not demand.holds(values).any():
                return self._sentence(demand, dict(zip(self.names, params.tolist())))
        if single is None:
            self._passed = params.tobytes()
        return ""

    def _sentence(self, demand: Demand, values: Mapping[str, float]) -> str:
        """Return the sentence on a demand; it names the parameters that are not above zero, or else all that enter the formula."""
        names = [name for name in self.names if name in demand.parameters]
        blamed = ([name for name in names if values[name] <= 0.0] or names)[:SHOWN]
        values_text = ", ".join(
            f"{name} = {values[name]:g} {self.units.get(name, '')}".rstrip() for name in blamed
        )
        if not values_text:
            return f"it must hold that {demand.rule}"
        return f"{values_text} {'are' if len(blamed) > 1 else 'is'} out of range: {demand.rule}"


def _gap_demands(e: Equations, units: Mapping[str, str]) -> list[Demand]:
    """Return demands on two facing walls: a weighted sum of their gaps is the space between them, wherever the bodies are."""
    slopes: dict[int, list[float]] = {}
    for j, gap in e.gap.items():
        row = derivatives([gap], e.x)[0]
        if all(not variables_of(entry) for entry in row):
            slopes[j] = [float(entry.number or 0.0) for entry in row]
    found = []
    for i, j in combinations(slopes, 2):
        one, other = np.array(slopes[i]), np.array(slopes[j])
        size, weight = float(one @ one), -float(one @ other)
        if not weight > 0.0 or np.abs(other * size + one * weight).max() > FORMULAS.same * weight:
            continue
        walls = " and ".join(repr(e.contacts[k].name) for k in (i, j))
        room = e.gap[i] * (weight / size) + e.gap[j]
        found.append(
            Demand(room, _open, f"walls {walls} leave no room between them{_least_value(room, units)}")
        )
    return found


def _least_value(room: Symbol, units: Mapping[str, str]) -> str:
    """Return, if the space depends linearly on one parameter, the value from which there is some."""
    names = [name for name in variables_of(room) if name.startswith("p_")]
    if len(names) == 1:
        slope, rest = (
            derivatives([room], [variable(names[0])])[0][0].number,
            replaced(room, dict.fromkeys(variables_of(room), 0.0)).number,
        )
        if slope and rest is not None:
            name = names[0].removeprefix("p_")
            limit = f"{-rest / slope + 0.0:g} {units.get(name, '')}".rstrip()
            return f"; give {name} {'above' if slope > 0.0 else 'below'} {limit}"
    return ""


def _masses(e: Equations) -> list[Demand]:
    """Return demands on the masses of bodies that hit walls or rub, if the machine declares its energy."""
    return [
        Demand(mass, _open, f"the mass that moves with {name} is above 0")
        for name, mass in e.body_masses().items()
    ]


def _contacts(e: Equations) -> list[Demand]:
    found = []
    for j, value in e.restitution.items():
        rule = f"the restitution of {e.contacts[j].described} is above 0 and at most 1"
        found.append(Demand(value, lambda r: (r > 0.0) & (r <= 1.0), rule))
        effect = e.toward(e.gap_rate(j), e.push[j])
        rule = f"an impulse at {e.contacts[j].described} changes the rate of its gap by a number"
        found.append(Demand(effect, np.isfinite, rule))
    for j in e.force:
        label = e.contacts[j].described
        found.append(Demand(e.limit[j], lambda x: x >= 0.0, f"the limit of {label} is 0 or above"))
        acceleration = replaced(e.friction_effect(j), e.without_forces)
        found.append(Demand(acceleration, _open, f"a force along the velocity of {label} makes it faster"))
    return found


def _rates(e: Equations) -> list[Demand]:
    rule = "motion's rate of {} is a number"
    return [Demand(rate, np.isfinite, rule.format(name)) for name, rate in zip(e.states, e.still)]


def _open(values: np.ndarray) -> np.ndarray:
    return np.isfinite(values) & (values > 0.0)


HERE = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
FAILS = {"divide": "a division by zero", "invalid": "no number"}


def singular_at(
    equations: Equations, params: np.ndarray, modes: Sequence[int], state: np.ndarray, clock: float
) -> str:
    """Return a formula that is undefined or not differentiable at a state, with the state, as part of a sentence; empty if there is none."""
    if not np.abs(state).max() < FORMULAS.runaway:
        return ""
    at = ", ".join(f"{name} = {value:.6g}" for name, value in zip(equations.states, state))
    if equations.phase_rate is not None:
        at += f", phase = {clock:.6g}"
    for label, formula in _on_numbers(equations, params, modes, state, clock):
        with np.errstate(divide="raise", invalid="raise", over="ignore"):
            try:
                formula()
            except (ArithmeticError, ValueError) as error:
                return f"{label} has {_named(error)}{_line(error)} at {at}"
    for label, symbols in _on_symbols(equations, modes):
        numbers = np.concatenate([params, equations.signs(modes)])
        slopes = [slope for row in derivatives(symbols, equations.x) for slope in row]
        if not np.isfinite(Values(equations.layout, slopes).one(state, clock, numbers)).all():
            return f"{label} has no slopes (a root of zero, or the like) at {at}"
    return ""


def _on_numbers(
    e: Equations, params: np.ndarray, modes: Sequence[int], state: np.ndarray, clock: float
) -> Iterator[tuple[str, Callable]]:
    """Yield the description of each formula of the machine file, and its call with numbers in place of symbols."""
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
        for kind, function in given.items():
            if callable(function):
                yield f"{kind} of {contact.described}", lambda f=function: f(*arguments)


def _on_symbols(e: Equations, modes: Sequence[int]) -> Iterator[tuple[str, list[Any]]]:
    yield "motion", e.pattern(e.pattern_key(modes)).rates
    for name, kind, j, table in e.formulas():
        if kind in ("gap", "velocity", "surface"):
            yield name, [table[j]]


def _named(error: Exception) -> str:
    text = str(error)
    if isinstance(error, ZeroDivisionError):
        return FAILS["divide"]
    return next((reason for word, reason in FAILS.items() if word in text), text)


def _line(error: Exception) -> str:
    """Return the last line of the machine file that was being evaluated, if its text is known."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not f.filename.startswith(HERE)]
    if not frames or frames[-1].lineno is None:
        return ""
    text = linecache.getline(frames[-1].filename, frames[-1].lineno).strip()
    return f" (line {frames[-1].lineno} of the machine file: {text})" if text else ""
