"""Units of a machine file, in which numbers are given and shown (its formulas receive SI units), and measures that need them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from contvines.shared.motions import BAND
from contvines.shared.near_names import did_you_mean
from orbits.machines.page.page import PageError
from orbits.machines.physical.quantities import QuantityError
from orbits.machines.physical.units import counted, in_si, size

if TYPE_CHECKING:
    from orbits.machines.page.patterns import Equations
    from orbits.symbols import Symbol

OF_A_STATE = ("max", "min", "max_abs", "first", "strobe")
"""Measures of single states; the last one only for forced machines."""
CONTACT = "contact_time"
"""Name of the parameter for the duration of an impact, in seconds; the motion does not depend on it."""
OF_LOADS = {
    "impact_rate": "Hz", "impulse": "N s", "impact_energy": "J", "impact_loss": "J", "friction_loss": "J", "mean_force": "N",
    "work_rate": "W", "peak_force": "N",
}  # fmt: skip
"""Units of measures of contacts; ``impulse_R`` has that of ``impulse``."""
LONGEST = 50.0  # largest length among the parameters, over the typical size of a state


Given = TypeVar("Given")


class Units:
    """Units by name of parameter or state; the clock is in SI units, and a forcing frequency in hertz counts turns.

    Raises
    ------
    PageError
        If a name or a unit is unknown.
    """

    def __init__(
        self,
        units: Mapping[str, str] | None,
        states: Sequence[str],
        parameters: Sequence[str],
        phase_rate: str | None,
    ) -> None:
        if not isinstance(units or {}, Mapping):
            raise PageError(f"units = {units!r} must have a unit for each name, for example {{'gap': 'mm'}}")
        self.given, self.factors = dict(units or {}), {}
        for name, unit in self.given.items():
            if name not in (*states, *parameters):
                hint = did_you_mean(name, [*states, *parameters])
                raise PageError(f"units: {name!r} is no state and no parameter{hint}")
            try:
                self.factors[name] = in_si(unit)
            except QuantityError as error:
                raise PageError(f"units: {name} = {error}") from None
            if name == phase_rate:
                turns = size(unit, "rad/s")
                if turns is None:
                    raise PageError(f"units: {name} = {unit!r}: a forcing's frequency is in 'Hz' or 'rad/s'")
                self.factors[name] = turns

    def number(self, name: str, value: Given | str) -> Given | float:
        """Return a value, such as "1.2 mm", in the unit of its name; a number is already in that unit."""
        return counted(name, value, self.given.get(name, "")) if isinstance(value, str) else value

    def sizes(self, states: Sequence[str], parameters: Mapping[str, float], rate: float) -> np.ndarray:
        """Return the typical size of each state in its unit, at least 1; 1 for states that are neither lengths nor speeds.

        No parameter is a length of more than `LONGEST` typical lengths. A typical speed is a typical length times the rate (radians per second).
        """
        unit = {name: size(text, "m") for name, text in self.given.items()}
        units = [unit[name] for name in states if unit.get(name)]
        if not units:
            return np.ones(len(states))
        longest = max(
            (abs(value) * (unit.get(name) or 0.0) for name, value in parameters.items()), default=0.0
        )
        length = max(min(one for one in units if one), longest / LONGEST)
        found = np.ones(len(states))
        for i, name in enumerate(states):
            speed = size(self.given[name], "m/s") if name in self.given else None
            if unit.get(name) or speed:
                found[i] = max(1.0, length * rate / speed if speed else length / (unit[name] or 1.0))
        return found

    def check(self, e: Equations) -> None:
        """Check that units match: in gaps and velocities that add quantities, and for states whose rate is another state.

        Raises
        ------
        PageError
        """
        kinds = {f"x_{name}": name for name in e.states} | {f"p_{name}": name for name in e.p.__dict__}
        for table, kind in ((e.gap, "gap"), (e.velocity, "velocity")):
            for j, value in table.items():
                names = [kinds[term] for term in _terms(value) if kinds.get(term) in self.given]
                for one, other in pairwise(names):
                    if size(self.given[one], self.given[other]) is None:
                        raise PageError(
                            f"units: the {kind} of {e.contacts[j].described} adds {one} in {self.given[one]!r} to {other} in "
                            f"{self.given[other]!r}; give units of one kind"
                        )
        for name, rate in zip(e.states, e.still):
            (term, *more) = _terms(rate)
            if not more and name in self.given and kinds.get(term) in self.given and term.startswith("x_"):
                unit, wanted = self.given[kinds[term]], f"{self.given[name]}/s"
                if size(unit, wanted) is None:
                    raise PageError(
                        f"units: the rate of {name}, in {wanted!r}, is {kinds[term]}, in {unit!r}; give {kinds[term]} in {wanted!r}, or in a unit of its kind"
                    )

    def shown(self, states: Sequence[str]) -> dict[str, str]:
        """Return units of parameters, states and measures by name."""
        if not self.given:
            return {}
        of_states = {
            f"{kind}_{name}": self.given[name] for name in states if name in self.given for kind in OF_A_STATE
        }
        bands = {name: self.given[states[0]] for name in BAND if states[0] in self.given}
        return {**self.given, **of_states, **bands, "period": "s", "time": "s", "approach_speed": "m/s"}


def _terms(value: Symbol) -> list[str]:
    """Return the variables in a sum, each with a numeric factor; "" for any other term."""
    if value.operation in "+-":
        return [term for part in value.operands for term in _terms(part)]
    while value.operation in "*/":
        one, other = value.operands
        if other.number is None and (value.operation == "/" or one.number is None):
            return [""]
        value = other if other.number is None else one
    return [value.operands[0] if value.operation == "variable" else ""]


def load_names(e: Equations, parameters: Collection[str]) -> tuple[str, ...]:
    """Return the measures of a machine's contacts: forces and energies need its energy, a peak force the duration of an impact."""
    if e.energy is None:
        return ("impact_rate",) if e.gap else ()
    found: list[str] = []
    if e.gap:
        letters = [e.contacts[j].letter for j in e.gap]
        found += ["impact_rate", "impulse", *(f"impulse_{letter}" for letter in letters if len(letters) > 1)]
        found += ["impact_energy", "impact_loss", "mean_force"]
        found += ["peak_force"] if CONTACT in parameters else []
    return (*found, *(["friction_loss"] if e.force else []), *(["work_rate"] if found or e.force else []))
