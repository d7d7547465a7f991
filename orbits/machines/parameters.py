"""Parameters of a machine: name, meaning, unit, symbol and limits, and how its numbers depend on the varying parameter.

All checks, studies, tables and axes use these definitions. A parameter may depend on a condition, such as a temperature (`Table`).

The numbers in the equations are products of powers of the named parameters. If a machine is given by its numbers, each parameter is one
of them; a physical quantity may change several: the half-width of the cavity changes the dimensionless gravity and forcing together. As
one parameter p varies, number j is ``path[0, j] * p**path[1, j]``, or constant if ``path[1, j]`` is 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

LARGEST = 1_000_000.0
"""Largest number in a study, in the machine's own units, in which numbers are of order one; its square is far from overflow."""


class ParameterError(ValueError):
    """An impossible value of a parameter; the message names parameter, value and remedy."""


@dataclass(frozen=True)
class Limits:
    """An interval of numbers.

    Attributes
    ----------
    low, high : float
        Ends of the interval; infinite if there is none.
    open : bool
        Whether `low` itself is excluded.
    """

    low: float = -math.inf
    high: float = math.inf
    open: bool = False

    def __contains__(self, value: float) -> bool:
        return (self.low < value if self.open else self.low <= value) and value <= self.high

    @property
    def text(self) -> str:
        """The interval in words, to follow "a number"."""
        if self.low == -math.inf and self.high == math.inf:
            return "that is finite"
        if self.high == math.inf:
            return f"above {self.low:g}" if self.open else f"{self.low:g} or above"
        if self.open:
            return f"above {self.low:g} and at most {self.high:g}"
        return f"from {self.low:g} to {self.high:g}"

    @property
    def in_studies(self) -> Limits:
        """The same interval for values in studies: without huge values and, if 0 is excluded, without tiny ones."""
        if self.open and self.low == 0.0:
            return Limits(1.0 / LARGEST, min(self.high, LARGEST))
        return Limits(max(self.low, -LARGEST), min(self.high, LARGEST), self.open)


POSITIVE = Limits(0.0, open=True)
NOT_NEGATIVE = Limits(0.0)
RESTITUTION = Limits(0.0, 1.0, open=True)
SLOPE = Limits(-0.5 * math.pi, 0.5 * math.pi)


@dataclass(frozen=True)
class Parameter:
    """One parameter of a machine.

    Attributes
    ----------
    name : str
        Name in studies and in Python.
    meaning : str
        Meaning in a few words.
    limits : Limits
        Possible values.
    symbol : str
        Symbol in formulas, in TeX without dollars.
    unit : str
        Unit; "" for a pure number.
    example : float
        A usual value.
    words : mapping
        Words that stand for values.
    """

    name: str
    meaning: str
    limits: Limits
    symbol: str
    unit: str = ""
    example: float = 1.0
    words: Mapping[str, float] = field(default_factory=dict)

    def number(self, value: object) -> float:
        """Return the number for a value.

        Raises
        ------
        ParameterError
            If it is neither a finite number within the limits nor one of the words.
        """
        name = self.name
        if isinstance(value, str) and self.words:
            if value not in self.words:
                choices = ", ".join(f'"{word}"' for word in self.words)
                raise ParameterError(
                    f"{name} = {value!r} is unknown; give {choices} or a number {self.limits.text}"
                )
            return self.words[value]
        try:
            number = float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            raise ParameterError(
                f"{name} = {value!r} is not a number; give a number {self.limits.text}"
            ) from None
        if not math.isfinite(number):
            raise ParameterError(f"{name} = {number} is not finite; give a number {self.limits.text}")
        if number not in self.limits:
            raise ParameterError(f"{name} = {number:g} is out of range; give a number {self.limits.text}")
        return number

    def named(self, value: object) -> str | float:
        """Return the word for a value if there is one, else the number."""
        number = self.number(value)
        return next((word for word, code in self.words.items() if code == number), number)


AMPLITUDE = Parameter("amplitude", "amplitude of v", NOT_NEGATIVE, "C", "b", 0.55)
MASS_RATIO = Parameter(
    "mass_ratio", "absorber's mass over the oscillator's", NOT_NEGATIVE, r"\varepsilon", "", 0.006
)
FRICTION = Parameter("friction", "Coulomb coefficient", NOT_NEGATIVE, r"\mu", "", 0.5)
GRAVITY = Parameter("gravity", "g / (b omega_0^2)", NOT_NEGATIVE, r"\tilde g", "b omega_0^2", 0.211)
CONTACT_TIME = Parameter("contact_time", "duration of an impact", POSITIVE, "T_c", "", 0.05)
FREQUENCY = Parameter("frequency", "excitation frequency", POSITIVE, r"\Omega", "omega_0", 1.0)


@dataclass(frozen=True)
class Table:
    """A parameter as a function of a condition.

    Attributes
    ----------
    parameter, condition : str
        Their names.
    places, values : tuple of float
        Values of the condition, ascending, and of the parameter.
    """

    parameter: str
    condition: str
    places: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        steps = np.diff(self.places)
        if len(self.places) < 2 or len(self.places) != len(self.values) or not np.all(steps > 0.0):
            raise ParameterError(
                f"{self.parameter} over {self.condition}: give two rows or more [{self.condition}, {self.parameter}], {self.condition} ascending"
            )

    def __call__(self, condition: float) -> float:
        """Return the parameter's value, linear between two rows.

        Raises
        ------
        ParameterError
            If the condition lies outside the table.
        """
        low, high = self.places[0], self.places[-1]
        if not low <= condition <= high:
            raise ParameterError(
                f"{self.condition} = {condition:g} lies outside the table of {self.parameter}, which goes from {low:g} to {high:g}: "
                f"give a row for it, or a {self.condition} within"
            )
        return float(np.interp(condition, self.places, self.values))


def resolved(tables: Iterable[Table], values: Mapping[str, float]) -> dict[str, float]:
    """Return values in which conditions are replaced by the parameters that depend on them.

    Raises
    ------
    ParameterError
        If a condition lies outside its table.
    """
    found = dict(values)
    for table in tables:
        if table.condition in values:
            found[table.parameter] = table(values[table.condition])
            found.pop(table.condition, None)
    return found


def place(params, path, p, out):
    """Write the numbers at p, then their derivatives by p, into `out` (2 P,)."""
    count = params.shape[0]
    for j in range(count):
        power = path[1, j]
        if power == 0.0:
            out[j] = params[j]
            out[count + j] = 0.0
        elif power == 1.0:
            out[j] = path[0, j] * p
            out[count + j] = path[0, j]
        else:
            out[j] = path[0, j] * p**power
            out[count + j] = power * path[0, j] * p ** (power - 1.0)


def assign(data, other, value):
    """Set, in `data` and in place, the parameter that varies in `other`.

    Parameters
    ----------
    data, other : CycleData
        Of two problems of one machine.
    value : float
    """
    index = other.active
    params, path, active, amounts, law = data.params, data.path, data.active, data.amounts, data.law
    amounts[index] = value
    if law.shape[0] == 0:
        params[index] = value
        return
    for j in range(params.shape[0]):
        product = law[0, j]
        rest = law[0, j]
        for k in range(amounts.shape[0]):
            power = law[k + 1, j]
            if power != 0.0:
                factor = amounts[k] if power == 1.0 else amounts[k] ** power
                product *= factor
                if k != active:
                    rest *= factor
        params[j] = product
        path[0, j] = rest


def products(law: np.ndarray, amounts: np.ndarray) -> np.ndarray:
    """Return the numbers (P,) as products of powers of amounts (Q,); the rows of `law` (Q + 1, P) are factors, then exponents."""
    return law[0] * np.prod(amounts[:, None] ** law[1:], axis=0)


def single(count: int, index: int) -> np.ndarray:
    """Return the path (2, count) of a parameter that is the number `index` itself."""
    path = np.zeros((2, count))
    path[:, index] = 1.0
    return path


def along(path: np.ndarray, params: np.ndarray, p: np.ndarray | float) -> np.ndarray:
    """Return the numbers at each p: (P,) for one, (m, P) for an array (m,)."""
    value: float | np.ndarray
    if isinstance(p, float) or np.ndim(p) == 0:
        found, value = params.copy(), float(p)
    else:
        value = np.asarray(p, dtype=float)
        found = np.empty((*value.shape, params.size))
        found[...] = params
    factors, powers = path.tolist()
    for j, power in enumerate(powers):
        if power != 0.0:
            factor = factors[j]
            found[..., j] = factor * value if power == 1.0 else factor * value**power
    return found
