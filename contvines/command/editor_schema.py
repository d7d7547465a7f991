"""`contvines schema`: the JSON Schema of studies, from which editors complete and check them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from contvines.command.options import option

if TYPE_CHECKING:
    from pydantic import BaseModel

DIALECT = "http://json-schema.org/draft-07/schema#"  # what the TOML plugins of editors read


def schema(
    output: Annotated[
        Path | None,
        option("-o, --output FILE.json", "Where to write it; by default it is printed."),
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
        raise ValueError(
            f"{output}: cannot be written ({error.strerror}); choose another place with -o."
        ) from None
    typer.echo(f'{output}; the first line of a study beside it would be "#:schema {output.name}"')


def study_schema() -> dict[str, Any]:
    """The JSON Schema of every study: a machine by its name, the same in physical units, or a Python file's machine or flow.

    Returns
    -------
    dict
        Of draft 7. Fields, types, limits and defaults are those of the pydantic models; what needs two fields at once (a start outside
        its interval) is left to the commands.
    """
    from contvines.command.schema import FlowSections, PageSections, catalogue_model
    from orbits.machines.names import NAMES

    kinds = [_titled(inlined(catalogue_model(name)), f"the machine {name}") for name in NAMES]
    kinds += [made for made in map(_physical, NAMES) if made is not None]
    kinds = [_with_conditions(kind) for kind in kinds]
    own = [
        _own(inlined(PageSections), "a machine of a Python file"),
        _own(inlined(FlowSections), "a flow of a Python file"),
    ]
    return {
        "$schema": DIALECT,
        "title": "a study of contvines",
        "type": "object",
        "oneOf": [*kinds, {"title": "what a Python file declares", "anyOf": own}],
    }


def _titled(made: dict[str, Any], title: str) -> dict[str, Any]:
    sections = {"model": made["properties"].pop("model") | {"title": title}, **made["properties"]}
    return made | {"title": title, "properties": sections}


def _with_conditions(made: dict[str, Any]) -> dict[str, Any]:
    """A study whose parameters may be tables over a condition."""
    row = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2}
    table = {
        "type": "object",
        "description": "a table over one condition, for example { temperature = [[20, 0.7], [80, 0.6]] }",
        "additionalProperties": {"type": "array", "items": row, "minItems": 2},
        "minProperties": 1,
        "maxProperties": 1,
    }
    model = made["properties"]["model"]
    entries = {
        name: kind
        if name in ("name", "units", "unusual", "contact_time")
        else {key: kind[key] for key in ("description", "default") if key in kind} | {"anyOf": [kind, table]}
        for name, kind in model["properties"].items()
    }
    conditions = {
        "type": "object",
        "description": "values of conditions",
        "additionalProperties": {"type": "number"},
    }
    sections = {**made["properties"], "model": model | {"properties": entries}, "conditions": conditions}
    return made | {"properties": sections}


def _physical(name: str) -> dict[str, Any] | None:
    """A machine in kilograms and hertz; quantities with a unit are text. None for one that has no quantities."""
    from pydantic import Field

    from contvines.command.schema import StudySections, study_model
    from orbits.machines.names import model_class
    from orbits.machines.physical.machine import CONTACT, tables
    from orbits.machines.physical.quantities import QuantityError

    try:
        known = tables(model_class(name)).quantities
    except QuantityError:
        return None
    fields: dict[str, Any] = {
        key: Annotated[
            str if entry.unit else str | float,
            Field(description=f"{entry.meaning}; for example {entry.example}"),
        ]
        for key, entry in known.items()
    }
    contact = f"{CONTACT.meaning}; for example {CONTACT.example}"
    settings: dict[str, Any] = {
        "name": (Literal[name], ...),  # type: ignore[valid-type]
        "units": (Literal["si"] | None, None),
        "unusual": (Annotated[bool, Field(description="allow sizes that nobody builds")], False),
        **{key: (fields[key] | None, entry.default) for key, entry in known.items()},
        CONTACT.name: (Annotated[str | None, Field(description=contact)], None),
    }
    made = _with_units(inlined(study_model(StudySections, settings, fields)))
    made["properties"]["units"] = {"const": "si"}
    said = {"required": ["units"]}
    return _titled(made, f"the machine {name} in physical units") | {
        "anyOf": [said, {"properties": {"model": said}}]
    }


def _own(made: dict[str, Any], title: str) -> dict[str, Any]:
    """What a Python file declares, distinguished from the others by the name of its file; its parameters are known when that has run."""
    from orbits.machines.names import PAGES, STRUCTURE

    about = f'a file beside the study, and the machine or flow in it: "file.py:name"; or one that comes with the package: {", ".join([STRUCTURE, *PAGES])}'
    name = {"type": "string", "pattern": "|".join([r"\.py", STRUCTURE, *PAGES]), "description": about}
    made["properties"]["model"] = {"type": "object", "properties": {"name": name}, "required": ["name"]}
    made["properties"]["start"]["additionalProperties"] = True
    return made | {"title": title, "required": ["model", *made["required"]]}


def inlined(model: "type[BaseModel]") -> dict[str, Any]:
    """The schema of a pydantic model without references, and without the null that TOML does not have."""
    made = model.model_json_schema(by_alias=True)
    shared = made.pop("$defs", {})

    def told(value: object) -> object:
        if isinstance(value, list):
            return [told(entry) for entry in value]
        return told_of(value) if isinstance(value, dict) else value

    def told_of(value: dict[str, Any]) -> dict[str, Any]:
        kept: dict[str, Any] = {k: told(v) for k, v in value.items() if not _said_already(k, v)}
        if "$ref" in kept:
            kept = told_of(shared[kept.pop("$ref").rpartition("/")[2]]) | kept
        choices = [entry for entry in kept.get("anyOf", ()) if entry != {"type": "null"}]
        if len(choices) == 1:
            kept = choices[0] | {k: v for k, v in kept.items() if k != "anyOf"}
        elif choices:
            kept["anyOf"] = choices
        return kept

    return told_of(made)


def _said_already(key: str, value: object) -> bool:
    """Whether an entry says nothing to an editor: titles made from names, defaults that are none or whole sections."""
    return (key == "title" and isinstance(value, str)) or (
        key == "default" and (value is None or isinstance(value, dict))
    )


def _with_units(value: dict[str, Any]) -> dict[str, Any]:
    """Lists of numbers become lists of numbers or of text with a unit."""
    if value.get("items") == {"type": "number"}:
        return value | {"items": {"type": ["number", "string"]}}
    return {k: v if k == "guess" else _part_with_units(v) for k, v in value.items()}


def _part_with_units(value: object) -> object:
    if isinstance(value, list):
        return [_part_with_units(entry) for entry in value]
    return _with_units(value) if isinstance(value, dict) else value
