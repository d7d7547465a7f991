"""`contvines schema`: the JSON Schema of studies, from which editors complete and check them."""

from pathlib import Path
from typing import Annotated, Any

import typer

DIALECT = "http://json-schema.org/draft-07/schema#"  # what the TOML plugins of editors read


def schema(
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE.json", help="Where to write it; by default it is printed."
        ),
    ] = None,
) -> None:
    """Print the JSON Schema of studies, for editors that complete and check TOML.

    contvines schema -o study.schema.json, and "#:schema study.schema.json" as
    the first line of a study beside it, is what Taplo and Even Better TOML read.
    """
    import json

    text = json.dumps(study_schema(), indent=1, ensure_ascii=False) + "\n"
    if output is None:
        typer.echo(text, nl=False)
        return
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{output}: cannot be written ({error.strerror}).") from None
    typer.echo(f'{output}; the first line of a study beside it would be "#:schema {output.name}"')


def study_schema() -> dict[str, Any]:
    """The JSON Schema of every study: a machine by its name, the same in physical units, or a page of Python.

    Returns
    -------
    dict
        Of draft 7. Fields, types, limits and defaults are those of the pydantic models and of the machines' tables; what needs two
        fields at once (a start outside its interval) is left to the commands.
    """
    from orbits.machines.catalogue import NAMES

    kinds = [_plain(name) for name in NAMES]
    kinds += [made for made in map(_physical, NAMES) if made is not None]
    return {
        "$schema": DIALECT,
        "title": "a study of contvines",
        "type": "object",
        "oneOf": [*kinds, _page()],
    }


def _plain(name: str) -> dict[str, Any]:
    """A machine of the catalogue, in its own units."""
    from pydantic import TypeAdapter

    from contvines.command.schema import MODEL_SECTIONS, PARAMETERS, StudySections
    from orbits.machines.catalogue import model_class

    entries = {entry.name: entry for entry in model_class(name).settable}
    model = inlined(MODEL_SECTIONS[name])
    model["properties"] = {k: _explained(v, entries.get(k)) for k, v in model["properties"].items()}
    start = {k: _explained(TypeAdapter(v).json_schema(), entries[k]) for k, v in PARAMETERS[name].items()}
    return _joined(inlined(StudySections), f"the machine {name}", model, start)


def _explained(field: dict[str, Any], entry: Any) -> dict[str, Any]:
    """A field with its meaning and an example; words that stand for values are allowed beside numbers."""
    if entry is None:
        return field
    if entry.words:  # limits behind a validator that turns words into numbers
        limits = entry.limits.in_studies
        number = {"type": "number", "minimum": limits.low, "maximum": limits.high}
        default = {"default": field["default"]} if "default" in field else {}
        field = {"anyOf": [{"enum": list(entry.words)}, number], **default}
    return field | {"description": f"{entry.meaning}; for example {entry.example:g}"}


def _physical(name: str) -> dict[str, Any] | None:
    """A machine in kilograms and hertz; quantities with a unit are text. None for one that has no quantities."""
    from contvines.command.schema import StudySections
    from orbits.machines.catalogue import model_class
    from orbits.machines.physical.machine import tables
    from orbits.machines.physical.quantities import QuantityError

    try:
        known = tables(model_class(name)).QUANTITIES
    except QuantityError:
        return None
    fields = {key: _quantity(entry) for key, entry in known.items()}
    title = f"the machine {name} in physical units"
    own = {
        "name": {"const": name},
        "units": {"const": "si"},
        "unusual": {"type": "boolean", "default": False, "description": "allow sizes that nobody builds"},
    }
    model = {
        "type": "object",
        "properties": {**own, **fields},
        "required": ["name"],
        "additionalProperties": False,
    }
    made = _joined(_with_units(inlined(StudySections)), title, model, fields)
    made["properties"]["units"] = {"const": "si"}
    said = {"required": ["units"]}
    return made | {"anyOf": [said, {"properties": {"model": said}}]}


def _quantity(entry: Any) -> dict[str, Any]:
    kind: dict[str, Any] = {"type": "string" if entry.unit else ["number", "string"]}
    default = {} if entry.default is None else {"default": entry.default}
    return kind | default | {"description": f"{entry.meaning}; for example {entry.example}"}


def _page() -> dict[str, Any]:
    """A machine from a page of Python, told from the others by the name of its file."""
    from contvines.command.page_study import PageStudyFile

    made = inlined(PageStudyFile)
    made["title"] = "a machine from a page of Python"
    made["properties"]["model"]["properties"]["name"] = {
        "type": "string",
        "pattern": r"\.py",
        "description": 'a file beside the study, and the machine in it: "file.py:machine"',
    }
    return made


def _joined(
    made: dict[str, Any], title: str, model: dict[str, Any], parameters: dict[str, Any]
) -> dict[str, Any]:
    """All sections of one machine: its own `[model]`, its parameters in `[start]`, their names where one is chosen."""
    sections = made["properties"]
    start = sections["start"]
    start["properties"] |= {k: {n: v for n, v in f.items() if n != "default"} for k, f in parameters.items()}
    start["additionalProperties"] = False
    for section in ("continue", "chart"):
        sections[section]["properties"]["parameter"] = {"enum": list(parameters)}
    return made | {
        "title": title,
        "properties": {"model": model | {"title": title}, **sections},
        "required": ["model", *made["required"]],
    }


def inlined(model: Any) -> dict[str, Any]:
    """The schema of a pydantic model without references, and without the null that TOML does not have."""
    made = model.model_json_schema(by_alias=True)
    shared = made.pop("$defs", {})

    def told(value: Any) -> Any:
        if isinstance(value, list):
            return [told(entry) for entry in value]
        if not isinstance(value, dict):
            return value
        kept = {k: told(v) for k, v in value.items() if not _said_already(k, v)}
        if "$ref" in kept:
            kept = told(shared[kept.pop("$ref").rpartition("/")[2]]) | kept
        choices = [entry for entry in kept.get("anyOf", ()) if entry != {"type": "null"}]
        if len(choices) == 1:
            kept = {k: v for k, v in kept.items() if k != "anyOf"} | choices[0]
        elif choices:
            kept["anyOf"] = choices
        return kept

    return told(made)


def _said_already(key: str, value: Any) -> bool:
    """Whether an entry says nothing to an editor: titles made from names, defaults that are none or whole sections."""
    return (key == "title" and isinstance(value, str)) or (
        key == "default" and (value is None or isinstance(value, dict))
    )


def _with_units(value: Any) -> Any:
    """Lists of numbers become lists of numbers or of text with a unit."""
    if isinstance(value, list):
        return [_with_units(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    if value.get("items") == {"type": "number"}:
        return value | {"items": {"type": ["number", "string"]}}
    return {k: v if k == "guess" else _with_units(v) for k, v in value.items()}
