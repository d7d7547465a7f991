"""What was measured: columns of a CSV in the units that their heads name, and quantities on the line, in the units of a study."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from orbits.machines.varying import Varying


_UNIT = re.compile(r"\[([^\]]*)\]|\(([^)]*)\)|/\s*([^/]+)$")
STANDARD_GRAVITY = 9.80665  # m/s^2; in the head of an acceleration, g is this and no gram


@dataclass(frozen=True)
class Column:
    """A column that is wanted.

    Attributes
    ----------
    what : str
        In words: "time", "acceleration".
    unit : str
        In which it is returned, and counted where its head names none; "" for a plain number.
    """

    what: str
    unit: str


def measured(path: Path, wanted: Sequence[Column]) -> list[np.ndarray]:
    """The columns of a CSV, each in the unit that is wanted.

    Raises
    ------
    ValueError
        If a row cannot be read, or a head names a unit of something else.
    """
    from orbits.design.columns import read_table

    heads, rows = read_table(path, len(wanted))
    factors = [
        _factor(path, number, heads[number - 1] if number <= len(heads) else "", column)
        for number, column in enumerate(wanted, 1)
    ]
    return [rows[:, k] * factor for k, factor in enumerate(factors)]


def _factor(path: Path, number: int, head: str, column: Column) -> float:
    from orbits.machines.physical import units

    match = _UNIT.search(head)
    said = next((part.strip() for part in match.groups() if part), "") if match else ""
    if not said or said in ("-", "1"):
        return 1.0
    place = f"{path}: the head of column {number}, {head!r},"
    if not column.unit:
        raise ValueError(
            f"{place} names a unit, but {column.what} is a plain number here: the study has no units; leave it out, "
            'or give the study units = "si".'
        )
    if said == "g" and column.unit == "m/s^2":
        return STANDARD_GRAVITY
    factor = units.size(said, column.unit)
    if factor is None:
        raise ValueError(
            f"{place} says {said!r}, which is no unit of this {column.what}; expected {column.unit}."
        )
    return factor


def length_on_line(text: str, option: str, unit: str) -> float:
    """A length or time that was given as an option: with its unit where the study has units, else a number.

    Parameters
    ----------
    text, option : str
    unit : str
        In which it is returned; "" where the study has none.
    """
    from orbits.machines.physical import units

    what = {"s": "time", "": "number"}.get(unit, "length")
    example = {"s": "2 s", "": "5"}.get(unit, "5 mm")
    match = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*", text)
    if match is None or match[2].startswith(","):
        comma = " (decimals stand behind a point)" if match else ""
        raise ValueError(f'{option} {text!r}: this is no {what}{comma}; for example "{example}".')
    number, said = float(match[1]), match[2]
    if not unit:
        if said:
            raise ValueError(
                f'{option} {text!r}: the study has no units; expected a plain number, or give the study units = "si".'
            )
        return number
    if not said:
        raise ValueError(f'{option} {text!r} has no unit; for example "{example}".')
    factor = units.size(said, unit)
    if factor is None:
        raise ValueError(f'{option} {text!r}: {said!r} is no unit of a {what}; for example "{example}".')
    return number * factor


def scales(model: Varying, params: np.ndarray) -> tuple[float, str, float, str]:
    """What a dimensionless length and time are in the units that a study shows, and these units ("" for plain numbers)."""
    from orbits.machines.physical import units
    from orbits.machines.physical.machine import Physical

    if not isinstance(model, Physical):
        return 1.0, "", 1.0, model.units.get("time", "")
    gauges = model.tables.GAUGES

    return (
        float(model.gauge("length", params)),
        units.unit_of(gauges["length"]),
        float(model.gauge("time", params)),
        units.unit_of(gauges["time"]),
    )
