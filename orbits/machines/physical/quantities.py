"""Physical quantities of a machine: products of powers of its dimensionless numbers and its scales.

The numbers of a machine and its scales (half-width b, rate omega_0, a mass) together are its *state*. A quantity is a constant times
a product of powers of them, so the state follows from as many independent quantities: the exponents are those of the inverse
matrix. The same matrix gives the effect of one quantity while the others are constant: each number is proportional to a power of it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.parameters import ParameterError


class QuantityError(ParameterError):
    """An impossible value of a physical quantity; the message names quantity, value and remedy."""


@dataclass(frozen=True)
class Quantity:
    """One physical quantity.

    Attributes
    ----------
    name : str
    unit : str
        SI unit in pint's notation; "" for a plain number.
    example : str
        A typical value, in the usual unit.
    powers : mapping
        Exponents of the numbers of the state.
    usual : (float, float)
        Range [SI] of real machines; values outside are probably mistakes.
    meaning : str
    constant : float
        Factor of the product of powers.
    group : str
        Quantities of one group are equivalent: one of them is given.
    zero : bool
        Whether 0 is possible.
    default : str or float, optional
        Value if neither it nor another of its group is given.
    signed : bool
        Whether it may be negative.
    """

    name: str
    unit: str
    example: str
    powers: Mapping[str, float]
    usual: tuple[float, float]
    meaning: str
    constant: float = 1.0
    group: str = ""
    zero: bool = False
    default: str | float | None = None
    signed: bool = False

    @property
    def choice(self) -> str:
        """The group, or the name if it has none."""
        return self.group or self.name


@dataclass(frozen=True, eq=False)
class Basis:
    """Independent quantities, as many as the state has numbers.

    Attributes
    ----------
    quantities : tuple of Quantity
    numbers : tuple of str
        Names of the state's numbers.
    units : float array (Q,)
        SI values of the units of the quantities.
    """

    quantities: tuple[Quantity, ...]
    numbers: tuple[str, ...]
    units: np.ndarray = field(repr=False)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the quantities."""
        return tuple(quantity.name for quantity in self.quantities)

    @cached_property
    def powers(self) -> np.ndarray:
        """Exponent of number j in quantity i, shape (Q, P)."""
        return np.array([[q.powers.get(name, 0.0) for name in self.numbers] for q in self.quantities])

    @cached_property
    def sizes(self) -> np.ndarray:
        """Value of each quantity if the product of powers is one, shape (Q,)."""
        return np.array([quantity.constant for quantity in self.quantities]) / self.units

    @cached_property
    def usual(self) -> np.ndarray:
        """Numeric defaults, else NaN, shape (Q,)."""
        return np.array([q.default if isinstance(q.default, float) else np.nan for q in self.quantities])

    @cached_property
    def law(self) -> np.ndarray:
        """The numbers as products of powers of the quantities, shape (Q + 1, P): factors, then exponents; see `orbits.machines.parameters.products`."""
        exponents = np.round(4.0 * np.linalg.inv(self.powers)) / 4.0 + 0.0  # exponents are integers or halves
        sizes = self.units / np.array([quantity.constant for quantity in self.quantities])
        return np.vstack([np.prod(sizes**exponents, axis=1), exponents.T])

    def amounts_of(self, numbers: np.ndarray) -> np.ndarray:
        """Return the quantities, in their units, from numbers (..., P); shape (..., Q)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            found = self.sizes * np.prod(numbers[..., None, :] ** self.powers, axis=-1)
        # a ratio of two zeros has its default
        return np.where(np.isnan(found), self.usual, found)


def independent(quantities: Mapping[str, Quantity], given: Collection[str]) -> tuple[Quantity, ...]:
    """Return one quantity of each group: the one that is given, else the first.

    Raises
    ------
    QuantityError
        If two of one group are given.
    """
    chosen: dict[str, Quantity] = {}
    for quantity in quantities.values():
        choice = quantity.choice
        if quantity.name not in given:
            chosen.setdefault(choice, quantity)
        elif choice in chosen and chosen[choice].name in given:
            raise QuantityError(
                f"{chosen[choice].name} and {quantity.name} say the same thing twice: leave one of them out"
            )
        else:
            chosen[choice] = quantity
    return tuple(chosen.values())


# other names in common use
OTHERWISE = {
    "acceleration": "base_acceleration",
    "amplitude": "base_amplitude",
    "cavity": "half_width",
    "clearance": "half_width",
    "excitation_frequency": "frequency",
    "force": "force_amplitude",
    "gap": "half_width",
    "omega": "frequency",
    "rpm": "frequency",
    "speed": "frequency",
    "spring": "stiffness",
}


def near_quantity(given: str, names: Collection[str]) -> str:
    """Return " (did you mean ...?)" if a quantity has another or a similar name, else an empty text."""
    other = OTHERWISE.get(given.lower())
    return f" (did you mean {other!r}?)" if other in names else did_you_mean(given, names)


def gauges(mass: Mapping[str, float]) -> dict[str, Quantity]:
    """Return one dimensionless unit of each kind of measure, in b, omega_0 and the absorber's mass.

    Parameters
    ----------
    mass : mapping
        Exponents of the machine's numbers in the absorber's mass.
    """
    kinds = {  # unit, example, exponents of b and omega_0, whether the mass counts
        "length": ("m", "1 mm", 1, 0, False),
        "area": ("m^2", "1 mm^2", 2, 0, False),
        "velocity": ("m/s", "1 mm/s", 1, 1, False),
        "energy": ("J", "1 mJ", 2, 2, True),
        "impulse": ("N s", "1 N s", 1, 1, True),
        "force": ("N", "1 N", 1, 2, True),
        "power": ("W", "1 mW", 2, 3, True),
        "time": ("s", "1 s", 0, -1, False),
        "rate": ("Hz", "1 Hz", 0, 1, False),
    }
    return {
        kind: Quantity(
            kind,
            unit,
            example,
            {"half_width": length, "natural_rate": rate, **(mass if heavy else {})},
            (0, 1),
            "",
        )
        for kind, (unit, example, length, rate, heavy) in kinds.items()
    }
