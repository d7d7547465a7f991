"""What every machine offers.

The contract, in words
----------------------
1. A model is a frozen dataclass. Its fields are the machine's parameters; `parameter_names` lists all numbers that its
   maps depend on, in the order of the compiled kernels' parameter vector. A name that is no field (`amplitude` of the
   reduced absorber) has to be given with each orbit.
2. `limits` gives for each parameter the closed or open interval of values that make sense, as text and as a test.
3. `node` is the number of unknowns per event; `node_names` names them after an impact and elsewhere.
4. `kernels` is the module with `linearise`, `margins` and `unpin` (signatures: `orbits.machines.absorber.maps`).
5. `scale` says which measures an orbit of the machine has; `measures` computes them for arrays of solutions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from types import ModuleType
from typing import Any, ClassVar, Self

import numpy as np

from orbits.machines.path import single

# what may be said of a value, and the test for it
POSITIVE = ("above 0", lambda value: value > 0.0)
NOT_NEGATIVE = ("0 or above", lambda value: value >= 0.0)
RESTITUTION = ("above 0 and at most 1", lambda value: 0.0 < value <= 1.0)


class ParameterError(ValueError):
    """A parameter without a sensible value; the sentence names it, its value and what would do."""


class Model:
    """Base of the machines; see the contract at the top of `orbits.machines.base`."""

    name: ClassVar[str]
    node: ClassVar[int]
    parameter_names: ClassVar[tuple[str, ...]]
    limits: ClassVar[Mapping[str, tuple[str, Any]]]
    default_parameter: ClassVar[str]
    default_measure: ClassVar[str] = "B"

    @property
    def kernels(self) -> ModuleType:
        """The module of compiled maps."""
        raise TypeError(f"{type(self).__name__} has no kernels")

    @classmethod
    def check(cls, name: str, value: float) -> float:
        """Return `value` as a float if parameter `name` may have it.

        Raises
        ------
        ParameterError
            If it is not a finite number within the parameter's limits.
        """
        says, test = cls.limits[name]
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise ParameterError(f"{name} = {value!r} is not a number; give a number {says}") from None
        if not math.isfinite(number):
            raise ParameterError(f"{name} = {number} is not finite; give a number {says}")
        if not test(number):
            raise ParameterError(f"{name} = {number:g} is out of range; give a number {says}")
        return number

    def _check_fields(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]
            if field.name in self.limits:
                object.__setattr__(self, field.name, self.check(field.name, getattr(self, field.name)))

    def vector(self, values: Mapping[str, float] | None = None) -> np.ndarray:
        """The parameter vector, shape (P,), with `values` in place of or beside the machine's own.

        Raises
        ------
        ParameterError
            If a name is unknown, a value out of range or a needed value missing.
        """
        given = dict(values or {})
        unknown = [name for name in given if name not in self.parameter_names]
        if unknown:
            raise ParameterError(
                f"{unknown[0]} is no parameter of the model {self.name!r}; it has "
                + ", ".join(self.parameter_names)
            )
        result = []
        for name in self.parameter_names:
            value = given.get(name, getattr(self, name, None))
            if value is None:
                raise ParameterError(f"{name} is missing: give a number {self.limits[name][0]}")
            result.append(self.coded(name, value))
        return np.array(result)

    def coded(self, name: str, value: Any) -> float:
        """The number that stands for a parameter's value in the parameter vector."""
        return self.check(name, value)

    # ------------------------------------------------------------------ the parameter that varies
    @property
    def amount_names(self) -> tuple[str, ...]:
        """Names of all parameters that may vary, in the order of `amounts`; here the numbers themselves."""
        return self.parameter_names

    def amounts(self, params: np.ndarray) -> np.ndarray:
        """Values of all parameters that may vary, shape (Q,)."""
        return params

    def amount(self, name: str, params: np.ndarray) -> float:
        """The value of one of them."""
        return float(self.amounts(params)[self.place_of(name)])

    def path(self, name: str, params: np.ndarray) -> np.ndarray:
        """How the numbers follow one of them while the others stay as in `params`, shape (2, P); see `orbits.machines.path`."""
        return single(params.size, self.place_of(name))

    @property
    def law(self) -> np.ndarray:
        """The numbers as products of powers of the amounts, shape (Q + 1, P); no rows where they are the numbers themselves."""
        return np.zeros((0, len(self.parameter_names)))

    def vector_at(self, name: str, value: float, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """`vector` with the parameter that may vary called `name` at `value`.

        Raises
        ------
        ParameterError
            As `vector` does.
        """
        return self.vector({**(values or {}), name: value})

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and measures by name; none here, where all are numbers."""
        return {}

    def gauge(self, kind: str, params: np.ndarray) -> np.ndarray | float:
        """What one dimensionless unit of a kind of measure ("length", "velocity", "energy", "area") is in `units`."""
        return 1.0

    def place_of(self, name: str) -> int:
        """Place of a parameter among `amount_names`.

        Raises
        ------
        ParameterError
            If there is none of this name.
        """
        if name not in self.amount_names:
            raise ParameterError(
                f"parameter = {name!r} is unknown to the model {self.name!r}; choose one of "
                + ", ".join(self.amount_names)
            )
        return self.amount_names.index(name)

    def friction_acceleration(self, params: np.ndarray) -> float:
        """a = (1 + eps) mu g, the friction's relative acceleration (dimensionless)."""
        names = self.parameter_names
        eps, mu, g = (float(params[names.index(name)]) for name in ("mass_ratio", "friction", "gravity"))
        return (1.0 + eps) * mu * g

    def settings(self) -> dict[str, Any]:
        """The machine's own fields by name, ready for JSON."""
        return {"name": self.name} | {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def changed(self, **values: Any) -> Self:
        """The same machine with other values."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return type(self)(**(own | values))
