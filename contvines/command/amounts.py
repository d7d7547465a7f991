"""Values of parameters on the command line: numbers in the file's units, or quantities with a unit of their own."""

from __future__ import annotations

import math
from collections.abc import Mapping


def amount(option: str, text: str, name: str, units: Mapping[str, str]) -> float:
    """A value of a parameter, counted in the file's unit.

    Parameters
    ----------
    option : str
        With which it was given, for refusals.
    text : str
        ``"7.9"``, or ``"7.9 Hz"`` where the parameter has a unit.
    name : str
        Of the parameter.
    units : mapping
        Units by name of parameter; those without one are missing.

    Raises
    ------
    ValueError
        If it is neither; the sentence says the way out.
    """
    try:
        value = float(text)
    except ValueError:
        unit = units.get(name, "")
        if not unit:
            raise ValueError(
                f"{option} {text}: {name} is a plain number here; for example {option} 0.5."
            ) from None
        from orbits.machines.physical.units import counted

        try:
            value = counted(name, text, unit)
        except ValueError as error:
            raise ValueError(f"{option} {text}: {error}.") from None
    if not math.isfinite(value):
        raise ValueError(f"{option} {text}: {name} must be finite.")
    return value


def inside(
    option: str, text: str, name: str, within: tuple[float, float], units: Mapping[str, str], owner: str
) -> float:
    """A value of a parameter inside the interval of a study or a file.

    Parameters
    ----------
    option, text, name, units
        As for `amount`.
    within : (float, float)
        The interval.
    owner : str
        The name of the interval, for refusals, as ``"[continue] within"``.

    Raises
    ------
    ValueError
        As `amount`, or if the value lies outside the interval.
    """
    value = amount(option, text, name, units)
    low, high = within
    if not low <= value <= high:
        unit = units.get(name, "")
        lies = (
            f"{name} = {value:.10g} {unit}".rstrip()
            + f" lies outside {owner} = [{low:.10g}, {high:.10g}] {unit}".rstrip()
        )
        raise ValueError(f"{option} {text}: {lies}; give a value inside the interval, or widen it.")
    return value


def interval(option: str, ends: tuple[str, str], name: str, units: Mapping[str, str]) -> tuple[float, float]:
    """Both ends of an interval, the lower one first.

    Raises
    ------
    ValueError
        As `amount`, or if the interval is empty or reversed.
    """
    low, high = (amount(option, text, name, units) for text in ends)
    if not low < high:
        shown = " ".join(repr(text) if " " in text else text for text in ends)
        raise ValueError(f"{option} {shown}: give the lower value first, then the higher one.")
    return low, high
