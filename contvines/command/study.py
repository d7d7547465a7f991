"""Read and check a TOML study, before any computation.

The error message for an invalid value names the field and the value, and suggests a remedy; all errors of a study are reported together.
Parameters may depend on a condition: `restitution = { temperature = [[20, 0.7], [80, 0.6]] }` and `[conditions] temperature = 45`.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from orbits.flows import machine_of
from orbits.machines.names import NAMES, PAGES, STRUCTURE, model_class
from orbits.machines.parameters import CONTACT_TIME, ParameterError, Table

from ..shared.files import is_database
from ..shared.near_names import did_you_mean
from .schema import UnknownModel, catalogue_model, expected_value, values_of
from .study_data import Sort, Study, built, refuse, validated, wrong_guess, wrong_intervals
from .study_data import StudyError as StudyError

QUANTITY = re.compile(r"\s*[-+]?[\d.]+(e[-+]?\d+)?\s*[a-zA-Z%].*")  # "3.2 kg"
LARGEST = 1_000_000  # largest number of characters of a study; usual studies have a few hundred
DEEPEST = 8  # deepest nesting; valid studies have one level of sections, and lists of lists
_LINE = re.compile(r"^\s*(?P<key>[\w.\-\"']+)\s*=\s*(?P<value>[^#]*?)\s*(#.*)?$")
_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
_WORD = re.compile(r"[^\W\d][\w.+ -]*")
_TRUE, _FALSE = ("yes", "on", "True", "TRUE"), ("no", "off", "False", "FALSE")
EXAMPLE = "{ temperature = [[20, 0.7], [80, 0.6]] }"


def read_study(path: str | Path) -> Study:
    """Read and check a TOML study.

    Raises
    ------
    StudyError
        If the file cannot be read, is not TOML, or contains an invalid value.
    """
    path = Path(path)
    if path.suffix == ".py" and path.is_file():
        raise StudyError(
            f"{path}: this is a file of Python: run it with python, or name it in a study, [model] name = "
            f'"{path.name}:NAME"; contvines new flow writes one.'
        )
    try:
        return study_of(path.read_text(encoding="utf-8-sig"), path)
    except FileNotFoundError:
        near = did_you_mean(path.name, (other.name for other in path.parent.glob("*.toml")))
        reason = f"there is no such file{near}; give the path of a TOML study."
    except IsADirectoryError:
        reason = "this is a folder; give the path of a TOML study."
    except OSError as error:
        reason = f"cannot be read ({error.strerror})."
    except UnicodeDecodeError:
        hint = (
            "It is a database: commands that take a study want the .toml file."
            if is_database(path)
            else "Save it as UTF-8."
        )
        reason = f"this is not a TOML file (it is no text in UTF-8). {hint}"
    raise StudyError(f"{path}: {reason}")


def study_of(text: str, path: Path) -> Study:
    """Check a study given as text; files that it names are searched for in the folder of `path`.

    Raises
    ------
    StudyError
        As `read_study`.
    """
    try:
        return replace(check_study(toml_data(text), path), text=text)
    except StudyError as error:
        raise StudyError(f"{path}: {error}") from error


def check_study(data: dict[str, Any], path: str | Path = "study") -> Study:
    """Check a study given as nested dicts; see `read_study`."""
    path, model = Path(path), data.get("model")
    section = model if isinstance(model, dict) else {}
    name = str(section.get("name", ""))
    try:
        data, conditions, tables = without_tables(data)
        if ".py" in name or name in (*PAGES, STRUCTURE):
            from .own_study import read_own as read
        elif "units" in data or "units" in section:
            from .physical_study import read_physical as read
        else:
            read = read_catalogue
            for key, value in section.items():
                if isinstance(value, str) and QUANTITY.fullmatch(value):
                    raise StudyError(
                        f'[model] {key} = {value!r}: quantities want units = "si" on the first line of the study.'
                    )
        study = replace(read(data, path), conditions=conditions, tables=tables)
        if study.continue_.kinds is not None:
            from .own_study import load_kinds

            kinds, digest = load_kinds(path, study.continue_.kinds)
            study = replace(study, all_kinds=kinds, kinds_digest=digest)
    except StudyError:
        raise
    except (ValueError, OSError) as error:
        raise StudyError(str(error)) from error
    return study


# ---------------------------------------------------------------------- built-in machines in their own numbers
def read_catalogue(data: dict[str, Any], path: Path) -> Study:
    """Check a study whose `[model]` names a machine of the catalogue.

    Raises
    ------
    StudyError
        If a value is invalid.
    """
    model = data.get("model")
    name = model.get("name") if isinstance(model, dict) else None
    if name not in NAMES:
        refuse(_without_machine(data, model, name))
    name = str(name)
    file = validated(catalogue_model(name), data)
    machine = model_class(name)
    entries = {entry.name: entry for entry in machine.settable}
    parameters = values_of(file, entries)

    def refusal(parameter: str, value: float) -> str:
        if value in entries[parameter].limits.in_studies:
            return ""
        expected = expected_value(entries[parameter])
        return f" leaves the range of {parameter} at {value!r}; expected {expected} at both ends."

    over, driver = file.continue_.parameter, machine.driven_by
    low, high = file.continue_.within
    if file.start.word is None:
        parameters.setdefault(over, 0.5 * (low + high))
    wrong = wrong_intervals(file, parameters.get(over), refusal)
    if over not in parameters and not wrong:
        wrong.append(
            f"[start] {over} is missing: it is the continuation parameter's first value; expected a number from {low!r} to {high!r}."
        )
    elif driver not in parameters and driver != over:
        wrong.append(f"[start] {driver} is missing; expected {expected_value(entries[driver])}.")
    refuse([*wrong, *wrong_guess(file.start.guess, machine)])
    own = machine.field_names()
    loose = {key: value for key, value in parameters.items() if key not in own}
    given = {key: value for key, value in parameters.items() if key in own}
    try:
        catalogued = machine_of({"name": name, **given, **values_of(file, [CONTACT_TIME.name])})
    except ValueError as error:
        raise StudyError(f"[model] {error}") from error
    return built(Study.of(path, Sort.CATALOGUE, name, parameters, file, model=catalogued, loose=loose))


def _without_machine(data: dict[str, Any], model: object, name: object) -> list[str]:
    """Return all errors of a study whose model is unknown that can be found without it."""
    machines = (*NAMES, *PAGES, STRUCTURE)
    names = f'{", ".join(map(repr, machines))}, or a machine of your own, "FILE.py:NAME"'
    if name is not None:
        hint = did_you_mean(name, machines) if isinstance(name, str) else ""
        wrong = f"[model] name = {repr(name)[:60]}: there is no such machine{hint}; expected {names}."
    elif isinstance(model, dict):
        wrong = f"[model] name is missing; expected {names}."
    elif model is None:
        wrong = 'the section [model] is missing; it holds name = "absorber" and its parameters.'
    else:
        wrong = f"model = {repr(model)[:60]} is not a section; write [model] on a line of its own, its keys below."
    validated(UnknownModel, data, [wrong])
    return [wrong]


# ---------------------------------------------------------------------- studies that result files keep
def kept_study(file: Path, source: object, trust: bool) -> tuple[Study, dict[str, Any]]:
    """Return the study stored in a result's file, checked as at its original path, and the stored data.

    Raises
    ------
    ValueError
        If the file has no study, or the study names Python files and `trust` is false.
    """
    if not isinstance(source, dict) or not source.get("text"):
        raise ValueError(
            f"{file}: this file keeps no study to run again: it was saved by a version that kept none, or from something else than a study; "
            f"contvines diagram STUDY.toml -o {file.stem}-again.vines computes the study anew."
        )
    data, place = toml_data(source["text"]), (file.absolute().parent / str(source["study"])).resolve()
    named = [str(data.get(part, {}).get(key, "")) for part, key in (("model", "name"), ("continue", "kinds"))]
    code = next((name for name in named if ".py" in name), None)
    if code is not None and not trust:
        raise ValueError(
            f"{file}: its study runs the code of {code!r} beside {place}; --trust allows it, for a file whose maker you trust."
        )
    return study_of(source["text"], place), source


def source_of(file: Path) -> dict[str, Any] | None:
    """Return the data about its study that a file stores, see `Study.kept`; None if there are none."""
    from ..store import Store

    with Store.open(file) as store:
        return (store.study or {}).get("source")


# ---------------------------------------------------------------------- TOML
def toml_data(text: str) -> dict[str, Any]:
    """Parse a TOML text to nested dicts.

    Raises
    ------
    StudyError
        If it is not TOML, too large, or nested too deeply.
    """
    if len(text) > LARGEST:
        raise StudyError(f"this is too long for a study ({len(text)} characters; at most {LARGEST}).")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"this is not valid TOML: {_hint(text) or error}.") from None
    except ValueError:  # of Python, which limits the length of numbers
        raise StudyError("this is not valid TOML: a number has thousands of digits.") from None
    except RecursionError:
        raise StudyError(
            "its values are nested too deeply; a study has sections of keys, one level deep."
        ) from None
    level: list[object] = [data]  # without recursion, which sections may exhaust
    for _ in range(DEEPEST + 1):
        level = [
            part
            for value in level
            if isinstance(value, dict | list)
            for part in (value.values() if isinstance(value, dict) else value)
        ]
    if any(isinstance(value, dict | list) for value in level):
        raise StudyError("its sections are nested too deeply; a study has sections of keys, one level deep.")
    return data


def _hint(text: str) -> str:
    """Describe a common mistake in the first line that is no TOML, with a remedy; empty if the mistake is not recognised."""
    lines = text.splitlines()
    for number, line in enumerate(lines, start=1):
        found = _LINE.match(line[:1000])
        if found and (habit := _habit(found["value"])):
            try:
                tomllib.loads("\n".join(lines[: number - 1]))
            except (ValueError, RecursionError):
                return ""
            return f"{found['key'][:60]} = {found['value'][:60]} (line {number}): {habit}"
    return ""


def _habit(value: str) -> str:
    if _COMMA.fullmatch(value):
        return f"decimals are written with a point: write {value.replace(',', '.')}"
    if value in (*_TRUE, *_FALSE):
        return f"write {'true' if value in _TRUE else 'false'}"
    if _WORD.fullmatch(value) and value not in ("true", "false", "inf", "nan"):
        return f'text stands in quotes: write "{value[:60]}"'
    return "" if value else "the value is missing"


# ---------------------------------------------------------------------- conditions
def without_tables(data: dict[str, Any]) -> tuple[dict[str, Any], dict[str, float], tuple[Table, ...]]:
    """Evaluate the parameters given as tables over a condition; return the study's data with their values, the conditions and the tables.

    Raises
    ------
    StudyError
        If a table or a condition is invalid, or the study varies a parameter that depends on a condition; the message names section and
        field.
    """
    conditions = _conditions(data.get("conditions", {}))
    plain, tables = {key: value for key, value in data.items() if key != "conditions"}, []
    for section in ("model", "start"):
        values = plain.get(section)
        if not isinstance(values, dict):
            continue
        plain[section] = dict(values)
        for name, entry in values.items():
            if not isinstance(entry, dict) or (section == "start" and name == "state"):
                continue
            table, unit = _table(f"[{section}] {name}", name, entry)
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
    conditions_used = {table.condition for table in tables}
    for name in conditions:
        if name not in conditions_used:
            raise StudyError(
                f"[conditions] {name} = {conditions[name]:g}: nothing depends on it{did_you_mean(name, conditions_used)}; a parameter would by a table, "
                f"for example restitution = {EXAMPLE.replace('temperature', name)}."
            )
    for section in ("continue", "chart"):
        entry = data.get(section)
        for table in tables:
            if isinstance(entry, dict) and entry.get("parameter") == table.parameter:
                raise StudyError(
                    f"[{section}] parameter = {table.parameter!r} depends on {table.condition}: give it one number in [model], or another parameter."
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


def _table(place: str, name: str, entry: Mapping[str, Any]) -> tuple[Table, str]:
    """Return a table with its values in the unit of the first one, and that unit."""
    rows = next(iter(entry.values()), None)
    pairs = isinstance(rows, list) and all(isinstance(row, list) and len(row) == 2 for row in rows)
    if len(entry) != 1 or not pairs:
        raise StudyError(
            f"{place} = {entry!r}: expected a number, or a table over one condition, {name} = {EXAMPLE}."
        )
    from orbits.machines.physical.quantities import QuantityError
    from orbits.machines.physical.units import counted, number_and_unit

    condition, unit = next(iter(entry)), ""
    places, values = [], []
    for place_text, value in rows:  # type: ignore[union-attr]
        try:
            if isinstance(value, str):
                unit = unit or number_and_unit(value)[1]
                value = counted(name, value, unit)
            places.append(float(place_text))
            values.append(float(value))
        except (QuantityError, TypeError, ValueError) as error:
            raise StudyError(
                f"{place}, the row [{place_text!r}, {value!r}]: {str(error).rstrip('.')}."
            ) from None
    try:
        return Table(name, condition, tuple(places), tuple(values)), unit
    except ParameterError as error:
        raise StudyError(f"{place}: {error}.") from None


def check_range(tables: Iterable[Table], name: str, values: Iterable[float], place: str) -> None:
    """Check that values of a condition lie in the range of the tables over it.

    Parameters
    ----------
    tables : iterable of Table
    name : str
        Of the condition.
    values : iterable of float
    place : str
        Field with the values, for the error message.

    Raises
    ------
    ValueError
        If a value lies outside.
    """
    for table in tables:
        for value in values if table.condition == name else ():
            try:
                table(value)
            except ParameterError as error:
                raise ValueError(f"{place}: {error}.") from None
