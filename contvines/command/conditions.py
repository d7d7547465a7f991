"""Parameters of a study that depend on a condition: `restitution = { temperature = [[20, 0.7], [80, 0.6]] }` and `[conditions] temperature = 45`.

The tables are taken out of the study and replaced by their values at the study's conditions before anything else reads it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from contvines.command.study_errors import StudyError
from contvines.shared.near_names import did_you_mean
from orbits.machines.parameters import ParameterError, Table

EXAMPLE = "{ temperature = [[20, 0.7], [80, 0.6]] }"


def without_tables(data: dict[str, Any]) -> tuple[dict[str, Any], dict[str, float], tuple[Table, ...]]:
    """A study's data with numbers, or texts, in place of tables, its conditions, and the tables.

    Raises
    ------
    StudyError
        If a table, or a condition, cannot be; the sentence names section and field.
    """
    given = data.get("conditions")
    conditions = _conditions(given) if given is not None else {}
    plain, tables = {key: value for key, value in data.items() if key != "conditions"}, []
    for section in ("model", "start"):
        values = plain.get(section)
        if not isinstance(values, dict):
            continue
        plain[section] = dict(values)
        for name, said in values.items():
            if not isinstance(said, dict) or (section == "start" and name == "state"):
                continue
            table, unit = _table(f"[{section}] {name}", name, said)
            if table.condition not in conditions:
                raise StudyError(
                    f"[{section}] {name} depends on {table.condition}, which has no value{did_you_mean(table.condition, conditions)}: "
                    f"for example [conditions] {table.condition} = {table.places[0]:g}."
                )
            try:
                value = table(conditions[table.condition])
            except ParameterError as error:
                raise StudyError(f"[conditions] {error}.") from None
            plain[section][name] = f"{value!r} {unit}" if unit else value
            tables.append(table)
    known = {table.condition for table in tables}
    for name in conditions:
        if name not in known:
            raise StudyError(
                f"[conditions] {name} = {conditions[name]:g}: nothing depends on it{did_you_mean(name, known)}; a parameter would by a table, "
                f"for example restitution = {EXAMPLE.replace('temperature', name)}."
            )
    return plain, conditions, tuple(tables)


def _conditions(given: object) -> dict[str, float]:
    if not isinstance(given, dict):
        raise StudyError(
            f"conditions = {given!r} is not a section; write [conditions] on a line of its own, temperature = 45 below."
        )
    for name, value in given.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise StudyError(f"[conditions] {name} = {value!r} is no finite number; for example {name} = 45.")
    return {name: float(value) for name, value in given.items()}


def _table(place: str, name: str, said: Mapping[str, Any]) -> tuple[Table, str]:
    """The table, its values counted in the unit of the first one, and that unit."""
    rows = next(iter(said.values()), None)
    pairs = isinstance(rows, list) and all(isinstance(row, list) and len(row) == 2 for row in rows)
    if len(said) != 1 or not pairs:
        raise StudyError(
            f"{place} = {said!r}: expected a number, or a table over one condition, {name} = {EXAMPLE}."
        )
    from orbits.machines.physical.quantities import QuantityError
    from orbits.machines.physical.units import counted, number_and_unit

    condition, unit = next(iter(said)), ""
    places, values = [], []
    for where, value in rows:  # type: ignore[union-attr]
        try:
            if isinstance(value, str):
                unit = unit or number_and_unit(value)[1]
                value = counted(name, value, unit)
            places.append(float(where))
            values.append(float(value))
        except (QuantityError, TypeError, ValueError) as error:
            raise StudyError(f"{place}, the row [{where!r}, {value!r}]: {str(error).rstrip('.')}.") from None
    try:
        return Table(name, condition, tuple(places), tuple(values)), unit
    except ParameterError as error:
        raise StudyError(f"{place}: {error}.") from None


def check_varied(data: Mapping[str, Any], tables: Iterable[Table]) -> None:
    """Refuse a study along a parameter that depends on a condition.

    Raises
    ------
    StudyError
    """
    for section in ("continue", "chart"):
        said = data.get(section)
        for table in tables:
            if isinstance(said, dict) and said.get("parameter") == table.parameter:
                raise StudyError(
                    f"[{section}] parameter = {table.parameter!r} depends on {table.condition}: give it one number in [model], or another parameter."
                )


def check_range(tables: Iterable[Table], name: str, values: Iterable[float], place: str) -> None:
    """Refuse values of a condition that lie outside of a table.

    Raises
    ------
    ValueError
    """
    for table in tables:
        for value in values if table.condition == name else ():
            try:
                table(value)
            except ParameterError as error:
                raise ValueError(f"{place}: {error}.") from None
