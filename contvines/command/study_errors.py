"""What is wrong with a study, in sentences that name the field, the value and a way out."""

import re
from typing import Any, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from contvines.command.schema import S, Section, kind_of
from contvines.shared.near_names import did_you_mean

UNION = re.compile(
    r"constrained-\w+|(list|dict)\[.*\]"
)  # types as pydantic names them in the place of an error
MOST = 20  # sentences in one refusal
SECTIONS = {
    "model": 'name = "absorber" and its parameters',
    "continue": 'what to vary and where, for example parameter = "amplitude", within = [0.2, 1.3]',
}
WANTED = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "text",
    "bool_type": "true or false",
}


class StudyError(ValueError):
    """A study that cannot be run; the message says which value and a way out."""


def validated(model: type[S], data: dict[str, Any], wrong: list[str] | None = None) -> S:
    """A study's sections, checked.

    Parameters
    ----------
    model : type of Section
        Of the whole study; see `contvines.command.schema.study_model`.
    data : dict
    wrong : list of str, optional
        Sentences that are reported, too.

    Raises
    ------
    StudyError
        With all that pydantic refuses, a sentence for each field.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        model_keys = {field.alias or name for name, field in model.model_fields.items()}
        found: dict[Any, str] = {}
        for each in error.errors():
            loc = [part for part in each["loc"] if not (isinstance(part, str) and UNION.fullmatch(part))]
            if (
                len(loc) == 1
                and each["type"] == "missing"
                and did_you_mean(str(loc[0]), data.keys() - model_keys)
            ):
                continue  # the misspelt section is reported
            union = len(loc) < len(each["loc"])  # of a field that may be one of several types, one sentence
            found.setdefault((*loc, "" if union else each["type"]), _sentence(model, each["type"], loc, each))
        raise together([*(wrong or ()), *found.values()]) from None


def refuse(wrong: list[str]) -> None:
    """Raise `StudyError` with these sentences, if there are any."""
    if wrong:
        raise together(wrong)


def together(sentences: list[str]) -> StudyError:
    """All sentences in one error."""
    unique = list(dict.fromkeys(sentences))
    if len(unique) == 1:
        return StudyError(unique[0])
    more = [f"and {len(unique) - MOST} more"] if len(unique) > MOST else []
    lines = [f"  - {sentence}" for sentence in unique[:MOST] + more]
    return StudyError("\n".join([f"{len(unique)} things to mend:", *lines]))


def _sentence(model: type[Section], kind: str, loc: list[int | str], error: ErrorDetails) -> str:
    section, value = _cut(str(loc[0])), _cut(repr(error["input"]))
    sections = {field.alias or name: field for name, field in model.model_fields.items()}
    if len(loc) == 1:
        if kind == "missing":
            return f"the section [{section}] is missing; it holds {SECTIONS[section]}."
        if kind == "extra_forbidden":
            known = ", ".join(f"[{name}]" for name in sections)
            hint = did_you_mean(section, sections)
            written = f"[{section}]" if isinstance(error["input"], dict) else f"{section} = {value}"
            return f"{written}: there is no such section{hint}; a study has {known}."
        return (
            f"{section} = {value} is not a section; write [{section}] on a line of its own, its keys below."
        )
    key, fields = _cut(str(loc[1])), _fields(sections[section])
    place = f"[{section}] {key}" + "".join(f"[{i}]" for i in loc[2:])
    if kind == "extra_forbidden":
        if section == "model" and key in _fields(sections["start"]):
            return f"[model] {key} = {value}: this belongs to [start], beside the word."
        hint = did_you_mean(key, fields)
        return f"{place} = {value}: there is no such field{hint}; known are {', '.join(fields)}."
    if kind == "literal_error":
        known = re.findall(r"'([^']*)'", str(error.get("ctx", {})["expected"]))
        what = "parameter" if key == "parameter" else "choice"
        return f"{place} = {value}: there is no such {what}{did_you_mean(str(error['input']), known)}; choose one of {', '.join(known)}."
    would = f"; expected {_expected(fields[str(loc[1])])}."
    if kind == "missing":
        return f"{place} is missing{would}"
    if kind == "finite_number":
        return f"{place} = {value} is not a finite number{would}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        return f"{place} = {value} is out of range{would}"
    if kind == "string_too_long":
        return f"{place} has {len(error['input'])} letters{would}"
    if kind in ("too_short", "too_long"):
        return f"{place} = {value} has {len(error['input'])} entries{would}"
    what = f"is not {WANTED[kind]}" if kind in WANTED else "cannot be used"
    return f"{place} = {value} {what}{would}"


def _fields(section: FieldInfo) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in kind_of(section).model_fields.items()}


def _expected(field: FieldInfo) -> str:
    """The value that a field expects: its description, or that of its type."""
    parts = (part for kind in get_args(field.annotation) for part in getattr(kind, "__metadata__", ()))
    return field.description or next(
        (part.description for part in parts if getattr(part, "description", None)), "another value"
    )


def _cut(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
