"""Refusals as sentences that name the field, the value and what would do."""

import re
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from contvines.command import schema
from contvines.command.schema import (
    EXCITATION,
    MODEL_SECTIONS,
    PARAMETERS,
)
from contvines.shared.near_names import did_you_mean
from orbits.machines.catalogue import NAMES, model_class

# What would do, for each field of a study that is no parameter; used in every sentence that refuses a value.
WOULD_DO = {
    "name": " or ".join(repr(name) for name in NAMES),
    "word": "a word of events such as 'LR', 'LtL' or 'tt', or of maps such as 'LR RL'",
    "periods": "a whole number from 1 to 4096",
    "guess": "a list with one [phase, B or w] per event of the word",
    "parameter": "the name of one of the model's parameters",
    "within": "two finite numbers [low, high] with low < high",
    "depth": "a whole number >= 0: how many switches deep",
    "virtual": "true or false",
    "tolerance": "a number in (0, 1e-3], for example 1e-10",
    "angle": "an angle between tangents in (0, 0.5] radians, for example 0.1",
    "max_step": "a number in (1e-9, 0.5], a share of the interval, for example 0.03",
    "max_points": "a whole number >= 1, for example 20000",
    "max_branches": "a whole number >= 1, for example 200",
    "bounds": "two numbers for each measure, for example bounds = { B = [-inf, 3.0] }",
    "count": "a whole number >= 2 and <= 1000000, for example 400",
    "transient": "a whole number of forcing periods from 0 to 1000000, for example 200",
    "vary": 'names and their values, for example half_width = ["10 mm", "15 mm"]',
    "outcomes": "a list of names, for example ['peak', 'activation']",
    "sampling": "'latin', 'sobol' or 'random'",
    "samples": "a whole number >= 1 and <= 1000000, for example 32",
    "seed": "a whole number >= 0",
    "gaps": "a whole number of values from 0 to 1000, for example 5",
    "values": "a whole number of values from 0 to 1000, for example 9",
    "starts": "a whole number of starts from 1 to 1000, for example 4",
    "max_period": "a whole number of forcing periods from 1 to 256, for example 16",
}
UNION = re.compile(
    r"constrained-\w+|(list|dict)\[.*\]"
)  # types as pydantic names them in the place of an error
MOST = 20  # sentences in one refusal
SECTIONS = {
    "model": 'name = "absorber" and its parameters',
    "start": 'a word, its periods and a first amplitude, for example word = "LR", periods = 1, amplitude = 0.55',
    "continue": 'what to vary and where, for example parameter = "amplitude", within = [0.2, 1.3]',
}


# of names that mean another thing in one of the sections
WOULD_DO_IN = {
    ("atlas", "values"): "a whole number of values from 1 to 10000, for example 16, or a list of values",
    ("atlas", "starts"): "a whole number of starts from 1 to 10000000, for example 256",
    ("atlas", "budget"): "a whole number of 1 or more, for example 500000",
    ("atlas", "scan"): "a whole number of further values from 0 to 1000000; 0: none",
}


def _section_models() -> dict[str, type[BaseModel]]:
    """The model of every section but `[model]`, by its name in a study."""
    found = {}
    for name, entry in schema.StudySections.model_fields.items():
        kinds = [entry.annotation, *get_args(entry.annotation)]
        found[entry.alias or name] = next(
            k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)
        )
    return found


_SECTION_MODELS = _section_models()


def would_do(key: str, machine: Any = None, section: str = "") -> str:
    """What would do for a field: a parameter of the machine of that name, or a field of the study."""
    if (section, key) in WOULD_DO_IN:
        return WOULD_DO_IN[section, key]
    if machine in NAMES and key in PARAMETERS[machine]:
        return schema.would_do(model_class(machine).parameter(key))
    return WOULD_DO.get(key, "another value")


def refusal_of(machine: str, section: str, key: str, value: Any) -> str | None:
    """The sentence that refuses a parameter's value, or None if it is fine."""
    try:
        kind = PARAMETERS[machine][key]
        TypeAdapter(kind, config=ConfigDict(strict=True, allow_inf_nan=False)).validate_python(value)
    except ValidationError as error:
        return sentence_of(
            {**error.errors()[0], "loc": (section, key), "input": value}, {"model": {"name": machine}}
        )
    return None


def sentences_of(refused: ValidationError, data: dict[str, Any]) -> list[str]:
    """Everything that pydantic refuses, a sentence each; of a field that may be one of several types, one."""
    found = {}
    for error in refused.errors():
        loc = tuple(part for part in error["loc"] if not (isinstance(part, str) and UNION.fullmatch(part)))
        found.setdefault((loc, loc == error["loc"] and error["type"]), {**error, "loc": loc})
    return [sentence_of(error, data) for error in found.values()]


def sentence_of(error: Any, data: dict[str, Any]) -> str:
    """One pydantic error as a sentence: field, value, what would do."""
    kind = error["type"]
    loc = [p for p in error["loc"] if p not in NAMES]
    section = _cut(str(loc[0]))
    value = error.get("input")
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        given = value.get("name") if isinstance(value, dict) else None
        if kind == "union_tag_not_found":
            return f"[model] name is missing; {WOULD_DO['name']} would do."
        hint = did_you_mean(given, PARAMETERS)
        return f"[model] name = {_show(given)}: no such model{hint}; {WOULD_DO['name']} would do."
    if len(loc) == 1:
        if kind == "missing":
            return f"the section [{section}] is missing; it holds {SECTIONS[section]}."
        if kind == "extra_forbidden":
            sections = ["model", *_SECTION_MODELS]
            hint = did_you_mean(section, sections)
            known = ", ".join(f"[{s}]" for s in sections)
            return f"{section} = {_show(value)}: no such section{hint}; a study has {known}."
        return f"{section} = {_show(value)} is not a section; write [{section}] on a line of its own, its keys below."
    key = _cut(str(loc[1]))
    place = f"[{section}] {key}" + "".join(f"[{i}]" for i in loc[2:])
    model = data.get("model")
    would = would_do(key, model.get("name") if isinstance(model, dict) else None, section)
    if kind == "missing":
        return f"[{section}] {key} is missing; {would} would do."
    if kind == "extra_forbidden":
        return unknown_field(section, key, value, _fields(section, data))
    if kind == "finite_number":
        return f"{place} = {_show(value)} is not a finite number; {would} would do."
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        return f"{place} = {_show(value)} is out of range; {would} would do."
    if kind in ("string_too_long", "string_too_short"):
        return f"{place} has {len(value)} letters; {would} would do."
    if kind in ("too_short", "too_long"):
        return f"{place} = {_show(value)} has {len(value)} entries; {would} would do."
    wanted = {
        "float_type": "a number",
        "int_type": "a whole number",
        "string_type": "text",
        "bool_type": "true or false",
    }
    what = f"is not {wanted[kind]}" if kind in wanted else "cannot be used"
    return f"{place} = {_show(value)} {what}; {would} would do."


def _fields(section: str, data: dict[str, Any]) -> list[str]:
    if section == "model":
        name = data.get("model", {}).get("name")
        return list(MODEL_SECTIONS.get(name, MODEL_SECTIONS[NAMES[0]]).model_fields)
    return list(_SECTION_MODELS[section].model_fields)


def unknown_field(section: str, key: str, value: Any, known: list[str]) -> str:
    if section == "model" and key in EXCITATION.values():
        return f"[model] {key} = {_show(value)}: this belongs to [start], beside the word."
    return (
        f"[{section}] {_cut(key)} = {_show(value)}: there is no such field{did_you_mean(key, known)}; "
        f"known are {', '.join(known)}."
    )


def _show(value: Any) -> str:
    return _cut(repr(value))


def _cut(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


def together(sentences: list[str]) -> str:
    unique = list(dict.fromkeys(sentences))
    if len(unique) == 1:
        return unique[0]
    more = [f"and {len(unique) - MOST} more"] if len(unique) > MOST else []
    return f"{len(unique)} things to mend:\n" + "\n".join(f"  - {s}" for s in unique[:MOST] + more)
