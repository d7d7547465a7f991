"""Quantities as text, read by pint: ``"15 mm"`` is 0.015 m, and ``"8 Hz"`` counts turns, never radians, per second."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from contvines.shared.on_demand import pip_install
from orbits.machines.parameters import Limits
from orbits.machines.physical.quantities import Quantity, QuantityError

_KINDS = {
    "kg": "mass",
    "m": "length",
    "Hz": "frequency",
    "N/m": "stiffness",
    "N s/m": "damping coefficient",
    "m/s^2": "acceleration",
    "N": "force",
    "m/s": "velocity",
    "J": "energy",
    "m^2": "area",
    "s": "time",
    "rad": "angle",
}
_USUAL = {
    "kg": ("g", "kg", "mg"),
    "m": ("mm", "cm", "um", "m"),
    "Hz": ("Hz", "kHz", "rpm", "rad/s"),
    "N/m": ("N/m", "N/mm", "kN/m"),
    "N": ("N", "mN", "kN"),
    "m/s^2": ("m/s^2", "mm/s^2"),
    "s": ("s", "ms"),
    "rad": ("rad", "deg"),
}
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*((?:[^\W\d]|%).*?|)\s*")

_SPREAD = re.compile(r"\d\s*(?!e[-+])(?:[^\W\d]+\s*)??(?:±|\+/?-|\.\.|–|-|to)\s*\d")
_COMMA = re.compile(r"\s*[-+]?\d*,\d")


@cache
def registry() -> Any:
    """Return pint's registry of units.

    Raises
    ------
    QuantityError
        If pint is not installed.
    """
    try:
        import pint
    except ImportError:
        raise QuantityError(
            f"quantities with units are read by pint, which is not installed: {pip_install('units')}"
        ) from None
    # without pint's cache on disk: two processes that start at once may read it half written, and it contains
    # paths of one installation
    return pint.UnitRegistry()


@cache
def _in_base(unit: str) -> Any:
    """Return one of a unit in base units, as pint counts it; None if it is no unit."""
    units = registry()
    try:
        return units.Quantity(1.0, units.parse_units(unit)).to_base_units()
    except Exception:  # pint raises many kinds of errors
        return None


@cache
def size(unit: str, kind: str) -> float | None:
    """Return how many of the SI unit `kind` one `unit` is; None if the dimensions differ.

    Radians are not counted as pure numbers: 1 rad/s is a frequency of 1/(2 pi) Hz.
    """
    if unit == kind:
        return 1.0
    one, wanted = _in_base(unit), _in_base(kind)
    if one is None or wanted is None or one.dimensionality != wanted.dimensionality:
        return None
    turns = one.units._units.get("radian", 0) - wanted.units._units.get("radian", 0)
    found = float(one.magnitude) / float(wanted.magnitude) * (2.0 * math.pi) ** -float(turns)
    return found if math.isfinite(found) and found > 0.0 else None


def in_si(unit: str) -> float:
    """Return one of a unit in SI units, with radians as pure numbers.

    Raises
    ------
    QuantityError
        If it is no unit.
    """
    one = _in_base(unit)
    if one is None:
        raise QuantityError(f"{unit!r} is no unit that is known; for example 'mm' or 'N s/m'")
    return float(one.magnitude)


def read(quantity: Quantity, value: object) -> tuple[float, str]:
    """Return a quantity as a number and the unit in which it was given.

    Parameters
    ----------
    quantity : Quantity
    value : str or number
        ``"15 mm"``; a plain number only if the quantity has no unit.

    Raises
    ------
    QuantityError
        If it is no number with a unit of this kind.
    """
    given = f"{quantity.name} = {value!r}"
    hint = f'for example "{quantity.example}"' if quantity.unit else f"for example {quantity.example}"
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise QuantityError(f"{given} is no quantity; {hint}{_survey_hint(quantity, value)}")
    if not isinstance(value, str):
        if quantity.unit and value != 0:
            raise QuantityError(f"{given} has no unit; {hint}")
        return _finite(quantity, float(value), given, hint), unit_of(quantity)
    number, unit = _parsed(quantity.name, value, quantity.unit, hint + _survey_hint(quantity, value), hint)
    if not quantity.unit:
        factor = size(unit, "") if unit else 1.0
        if factor is None:
            raise QuantityError(f"{given}: {quantity.name} is a plain number; {hint}")
        return _finite(quantity, number * factor, given, hint), ""
    factor = size(unit, quantity.unit)
    if factor is None:
        kind = _KINDS.get(quantity.unit, quantity.unit)
        other = next((name for kind_unit, name in _KINDS.items() if size(unit, kind_unit) is not None), None)
        meant = _spelling_hint(unit, quantity)
        if other is None:
            raise QuantityError(
                f"{given}: {unit!r} is no unit of {_with_article(kind)}{meant}; {hint}{_survey_hint(quantity, value)}"
            )
        fault = f"{unit!r} is the unit of {_with_article(other)}{meant}"
        raise QuantityError(f"{given}: {fault}, but {quantity.name} is {_with_article(kind)}; {hint}")
    return _finite(quantity, number, given, hint), unit


def number_and_unit(value: str) -> tuple[float, str]:
    """Split a text such as ``"15 mm"``; the unit may be missing.

    Raises
    ------
    QuantityError
        If it is no number with a unit.
    """
    match = _NUMBER.fullmatch(value)
    if match is None:
        raise QuantityError(f"{value!r} is not a number with a unit")
    return float(match[1]), match[2]


def counted(name: str, value: str, own: str) -> float:
    """Return a measure or the value of an option, given as text, ``"15 mm"``, in the unit in which it is shown.

    Parameters
    ----------
    name : str
        Name of the measure or the option.
    value : str
    own : str
        Its unit; "" for a plain number.

    Raises
    ------
    QuantityError
        If it is no number with a unit of this kind.
    """
    hint = f'for example "1 {own}"' if own else "expected a plain number"
    number, unit = _parsed(name, value, own, hint, hint)
    factor = size(unit, own) if unit else 1.0
    if factor is None:
        expected = f"shown in {own}" if own else "a plain number"
        raise QuantityError(f"{name} = {value!r}: {name} is {expected}; {hint}")
    return number * factor


def _parsed(name: str, value: str, kind: str, otherwise: str, with_unit: str) -> tuple[float, str]:
    """Return number and unit of a text; `otherwise` and `with_unit` are hints for errors (no number; unit of kind `kind` missing)."""
    match = _NUMBER.fullmatch(value)
    if match is None:
        expected = "a number with a unit" if kind else "a number"
        comma = " (decimals stand behind a point)" if _COMMA.match(value) else ""
        raise QuantityError(f"{name} = {value!r} is not {expected}{comma}; {otherwise}")
    if kind and not match[2]:
        raise QuantityError(f"{name} = {value!r} has no unit; {with_unit}")
    return float(match[1]), match[2]


def _survey_hint(quantity: Quantity, value: object) -> str:
    """Return a hint on surveys if several values are given in a quantity's place, else an empty text."""
    if not (isinstance(value, list) or _SPREAD.search(str(value))):
        return ""
    return f"; several values, or a tolerance, go into [survey], as vary.{quantity.name} = {{ uniform = [from, to] }}"


def _spelling_hint(unit: str, quantity: Quantity) -> str:
    """Return " (did you mean ...?)" if a usual unit differs in capitals or in one letter, else an empty text."""
    usual = [unit_of(quantity), *_USUAL.get(quantity.unit, ())]
    similar = [one for one in usual if one.lower() == unit.lower()]
    similar += [one for one in usual if len(one) == len(unit) > 1 and sum(map(str.__ne__, one, unit)) == 1]
    if unit == "g" and quantity.unit == "m/s^2":  # which is a gram
        similar = ["g_0"]
    return f" (did you mean {similar[0]!r}?)" if similar else ""


def _with_article(kind: str) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def unit_of(quantity: Quantity) -> str:
    """Return the unit of the quantity's example: the usual one."""
    match = _NUMBER.fullmatch(str(quantity.example))
    return match[2] if match and quantity.unit else ""


def si(quantity: Quantity, number: float, unit: str) -> float:
    """Return the SI value of a number in `unit`."""
    factor = size(unit, quantity.unit) if unit else 1.0
    assert factor is not None
    return number * factor


def text(value: float, unit: str) -> str | float:
    """Return a value with its unit, as `read` understands it."""
    return f"{value!r} {unit}" if unit else value


def check_usual(quantity: Quantity, value: float, given: str) -> None:
    """Check that a value is in the range of real machines.

    Raises
    ------
    QuantityError
        With this range, and the option that permits the value.
    """
    low, high = quantity.usual
    if (value == 0.0 and quantity.zero) or low <= value <= high:
        return
    unit = unit_of(quantity)
    factor = si(quantity, 1.0, unit)
    ends = f"{low / factor:.6g} to {high / factor:.6g}{' ' + unit if unit else ''}"
    raise QuantityError(
        f"{given} is implausible for {quantity.meaning}: expected {ends}; if it is meant, say unusual = true in [model]"
    )


def check_limits(quantity: Quantity, number: float, unit: str, limits: Mapping[str, Limits]) -> None:
    """Check a number in `unit` against the limits of a dimensionless parameter, if the quantity is equal to that parameter.

    Raises
    ------
    QuantityError
        With the limits in this unit.
    """
    parameter = next(iter(quantity.powers), "")
    if quantity.powers != {parameter: 1} or quantity.constant != 1.0 or parameter not in limits:
        return
    limit = limits[parameter]
    if si(quantity, number, unit) not in limit:
        factor = si(quantity, 1.0, unit)
        allowed = Limits(limit.low / factor, limit.high / factor, limit.open).text
        raise QuantityError(
            f"{quantity.name} = {text(number, unit)} is out of range; give a number {allowed}{' ' + unit if unit else ''}"
        )


def _finite(quantity: Quantity, value: float, given: str, hint: str) -> float:
    if not math.isfinite(value):
        raise QuantityError(f"{given} is not finite; {hint}")
    if quantity.signed:
        return value
    if value < 0.0 or (value == 0.0 and not quantity.zero):
        rule = "0 or above" if quantity.zero else "above 0"
        raise QuantityError(f"{given} is out of range; give a value {rule}, {hint}")
    return value
