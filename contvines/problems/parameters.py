"""Named parameters: values by name, one of which varies along a branch."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from contvines.shared.near_names import did_you_mean

if TYPE_CHECKING:
    from typing import NoReturn


class Parameters:
    """What ``F(u, p)`` reads: ``p.damping`` or ``p["damping"]``; values cannot be changed.

    Parameters
    ----------
    values : mapping of str to number
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> NoReturn:
        hint = did_you_mean(name, self)
        raise AttributeError(f"there is no parameter {name!r}{hint}; the problem has {', '.join(self)}")

    def __getitem__(self, name: str) -> complex:
        if not isinstance(name, str):
            first = next(iter(self))
            raise TypeError(f"p[{name!r}]: parameters have names; p.{first} or p[{first!r}] is one")
        return getattr(self, name)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"parameter {name!r} cannot be changed by the equations")

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dict__)

    def __len__(self) -> int:
        return len(self.__dict__)

    def __repr__(self) -> str:
        return f"Parameters({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"


UNNAMED = "p"  # what the parameter is called where nobody says


class ParameterSet:
    """The parameters of a problem: their values, and which one varies.

    A plain number stays a plain number: then there is one parameter, and ``F(u, p)`` gets its value itself.

    Parameters
    ----------
    given : number, or mapping of str to number
    varying : str
        Name of the parameter that varies; "p" in a mapping that does not have it stands for the first one.

    Raises
    ------
    ValueError
        If a name is no identifier, a value no finite number, the mapping is empty, or the name is not among them.
    """

    def __init__(self, given: Mapping[str, float] | float, varying: str) -> None:
        self.named = isinstance(given, Mapping)
        values: dict[str, Any] = dict(given) if isinstance(given, Mapping) else {varying: given}
        if not values:
            raise ValueError("there is no parameter; give at least one, for example {'p': 1.0}")
        for name, value in values.items():
            if not (isinstance(name, str) and name.isidentifier()) and self.named:
                raise ValueError(
                    f"the parameter {name!r} must have a name that Python can read, such as 'p1'"
                )
            try:
                values[name] = float(value)
            except (TypeError, ValueError):
                hint = "" if self.named else "; several parameters have names: {'a': 1.0, 'b': 2.0}"
                raise ValueError(f"parameter {name} = {value!r} must be a number{hint}") from None
            if not math.isfinite(values[name]):
                raise ValueError(f"parameter {name} = {value!r} must be finite")
        if varying not in values and varying != UNNAMED:
            hint = did_you_mean(varying, values)
            raise ValueError(f"there is no parameter {varying!r}{hint}; the problem has {', '.join(values)}")
        self.values: dict[str, float] = values
        self.varying = varying if varying in values else next(iter(values))

    @property
    def start(self) -> float:
        """Value of the parameter that varies, where the problem starts."""
        return self.values[self.varying]

    def assign(self, name: str, value: float) -> None:
        """Give a parameter another value, in place."""
        self.values[name] = float(value)

    def at(self, p: complex) -> Parameters | complex:
        """What the user's functions get as their second argument when the varying parameter is `p`."""
        return Parameters({**self.values, self.varying: p}) if self.named else p

    def against(self, varying: str, values: Mapping[str, float] | None = None) -> ParameterSet:
        """The same parameters with another one varying, and with some other values.

        Raises
        ------
        ValueError
            If a name is not among them.
        """
        changed = dict(values or {})
        for name in (varying, *changed):
            if name not in self.values:
                hint = did_you_mean(name, self.values)
                raise ValueError(
                    f"there is no parameter {name!r}{hint}; the problem has {', '.join(self.values)}"
                )
        merged = {**self.values, **changed}
        return ParameterSet(merged if self.named else merged[varying], varying)

    def given(self) -> dict[str, float] | float:
        """As they were given: a mapping, or a number."""
        return dict(self.values) if self.named else self.start


class Parametrised:
    """A problem with such parameters, ``values``."""

    values: ParameterSet

    @property
    def parameter(self) -> str:
        """Name of the parameter that varies."""
        return self.values.varying

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name; of the one that varies the value at the start."""
        return dict(self.values.values)

    @property
    def p0(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values.start
