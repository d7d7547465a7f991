"""`contvines help`, `new`, `doctor` and `schema`: help, a commented study to begin with, a check of the installation, the JSON Schema of studies."""

from __future__ import annotations

import difflib
import math
import textwrap
from enum import StrEnum
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ..continuation.settings import Settings
from ..shared.files import refuse_ending, refuse_place
from ..shared.on_demand import pip_install
from .cli import COMMANDS, command
from .frame import tell
from .options import JsonOption, argument, option

if TYPE_CHECKING:
    from pydantic import BaseModel


TASKS = {
    "Begin": ("help", "new", "doctor", "schema"),
    "Compute a diagram": ("diagram", "trace", "switch", "atlas", "sweep"),
    "Look at a result": ("show", "plot", "orbit", "report", "export", "rerun"),
    "Two parameters": ("locus", "chart", "circle"),
    "How safe is a motion": ("basins", "robustness", "prove"),
    "Design a device": ("design", "recommend", "survey", "transient", "random", "calibrate"),
}
"""Commands by task, in the order in which a user needs them."""

TOPICS = ("labels", "words", "cite")

WORDS = """An orbit's word lists its events over one period, in order:

  L R   impact on the left wall (w = +1), on the right wall (w = -1)
  t     turn: the sliding velocity passes zero and the mass slides back
  s     stick, with the slip that ends it
  ""    no event: the mass sticks all the time

LR repeats after one impact on each wall; LRLt after two impacts on the left,
one on the right and a turn. A study begins with `word` and `periods`, the
number of forcing periods after which the orbit repeats. `contvines orbit
FILE.vines LABEL` lists the events of an orbit with their times."""
EXTRAS = {
    "machines": ("heyoka",),
    "proofs": ("flint", "mpmath"),
    "units": ("pint",),
    "tables": ("pandas", "xarray", "h5netcdf", "networkx"),
    "surveys": ("dask", "distributed"),
    "report": ("plotly",),
}
"""Modules that each extra of pyproject.toml installs."""
DIALECT = "http://json-schema.org/draft-07/schema#"  # version of JSON Schema that TOML plugins of editors understand


def help(
    name: Annotated[
        str | None,
        argument("COMMAND|TOPIC", f"A command, or a topic: {', '.join(TOPICS)}. Without: all commands."),
    ] = None,
) -> None:
    """List the commands by task, or explain one command or topic.

    contvines help diagram says the same as contvines diagram --help.
    """
    if name in COMMANDS:
        own = command(str(name))
        with own.make_context(f"contvines {name}", [], resilient_parsing=True) as context:
            typer.echo(own.get_help(context))
    elif name == "words":
        typer.echo(WORDS)
    elif name == "cite":
        typer.echo(_cite())
    elif name == "labels":
        typer.echo(_labels())
    elif name is None:
        typer.echo(_by_task())
    else:
        near = difflib.get_close_matches(name, [*COMMANDS, *TOPICS], n=1)
        hint = f"did you mean {near[0]}?" if near else "`contvines help` lists the commands"
        raise ValueError(f"{name}: there is no such command or topic; {hint}")


def _by_task() -> str:
    listed = {name for names in TASKS.values() for name in names}
    tasks = {**TASKS, "Further commands": tuple(name for name in COMMANDS if name not in listed)}
    blocks = []
    for task, names in tasks.items():
        if names:
            lines = (
                textwrap.fill(
                    COMMANDS[name][1], 80, initial_indent=f"  {name:12}", subsequent_indent=" " * 14
                )
                for name in names
            )
            blocks.append("\n".join([task, *lines]))
    blocks.append(
        "Topics\n  labels      What LP, SB, PD, VG and the other labels mean.\n"
        "  words       How a motion is written: LR, LRtt.\n"
        "  cite        BibTeX of this version."
    )
    blocks.append(
        "A first study: contvines new absorber,\n"
        "then contvines diagram absorber.toml --plot absorber.png\n"
        "`contvines help COMMAND` explains one of them."
    )
    return "\n\n".join(blocks)


def _cite() -> str:
    from importlib.metadata import metadata

    package = metadata("contvines")
    author = package["Author"] or package["Author-email"] or "The contvines developers"
    return f"""@software{{contvines,
  title = {{contvines: continuation and bifurcation analysis of motions with impacts and friction}},
  author = {{{{{author}}}}}, year = {{2026}}, version = {{{package["Version"]}}}
}}
The model of the absorbers: Youssef, Karoui, Leine, doi:10.48550/arXiv.2505.04420."""


def _labels() -> str:
    from ..bifurcation.kinds import KINDS

    rows = [f"  {kind.label}  {kind.text or kind.name}{' (border)' if kind.border else ''}" for kind in KINDS]
    return "\n".join(
        [
            "A label is the kind and a number: SB1 is the first symmetry breaking. B1 is a branch.",
            "",
            *rows,
            "",
            "At a border an event appears or vanishes: a margin of the orbit is zero there.",
            "`contvines show FILE.vines` lists the special points of a result.",
        ]
    )


class Kind(StrEnum):
    """Kinds of studies that `new` writes."""

    absorber = "absorber"
    coupled = "coupled"
    cavity = "cavity"
    si = "si"
    machine = "machine"
    flow = "flow"


BESIDE = {Kind.machine: "machine.py", Kind.flow: "flow.py"}
"""Python file that is written beside a study of a kind, and that the study names."""


def new(
    kind: Annotated[
        Kind,
        argument(
            "KIND",
            "absorber, coupled, cavity, si (kilograms and hertz), machine (your own, a Python file) or flow (your own equations).",
        ),
    ],
    output: Annotated[
        Path | None,
        option("-o, --output FILE.toml", "Where to; by default KIND.toml here."),
    ] = None,
) -> None:
    """Write a commented study to begin with: every field with its meaning.

    contvines new absorber, then contvines diagram absorber.toml --plot
    absorber.png. A file that is there is never overwritten.
    """
    target = output or Path(f"{kind.value}.toml")
    refuse_ending(target, "toml")
    texts = {target: _template(f"{kind.value}.toml")}
    if kind in BESIDE:
        name = BESIDE[kind]
        file_name = f"{target.stem}.py"
        texts[target] = texts[target].replace(name, file_name)
        texts[target.with_name(file_name)] = _template(name)
    for path in texts:
        if path.exists():
            raise ValueError(f"{path}: this file is there already; choose another name with -o")
        refuse_place(path)
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
        typer.echo(str(path))
    typer.echo(f"next: contvines diagram {target} --plot {target.with_suffix('.png')}", err=True)


def _template(name: str) -> str:
    return (files("contvines.command") / "templates" / name).read_text(encoding="utf-8")


def doctor(json: JsonOption = False) -> None:
    """Print versions, the core that computes, the extras that are installed, and the result of a self-test.

    The self-test follows the symmetric motion of an absorber to its fold and
    compares it with the closed form; it takes about a second. Exit status 1
    if it fails.
    """
    from ..journal import provenance

    versions = provenance()
    extras = {name: all(find_spec(part) for part in parts) for name, parts in EXTRAS.items()}
    test = self_test()
    if json:
        tell(versions, {**versions, "extras": extras, "self_test": test})
    else:
        for name, value in versions.items():
            typer.echo(f"{name:>10}  {value}")
        for name, installed in extras.items():
            remark = "installed" if installed else f"missing; {pip_install(name)} adds it"
            typer.echo(f"{name:>10}  {remark}")
        verdict = "passed" if test["passed"] else "FAILED"
        typer.echo(
            f" self-test  {verdict}: fold at amplitude {test['found']:.12g}, closed form {test['closed_form']:.12g}"
        )
    if not test["passed"]:
        raise typer.Exit(1)


def self_test() -> dict[str, Any]:
    """Compare the fold of the absorber's symmetric motion, found by continuation, with its closed form.

    Returns
    -------
    dict
        "passed", "found" and "closed_form" (amplitudes).

    Notes
    -----
    The fold is the lowest point of the slow invariant manifold (Youssef, Karoui, Leine, symmetric periodic motions).
    """
    import contvines
    from orbits import Absorber
    from orbits.theory.manifolds import activation, friction_level, impact_loss

    absorber = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    graph = contvines.diagram(
        absorber.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.2, 0.6), depth=0
    )
    expected = float(activation(impact_loss(0.76), friction_level(0.5, 0.211, 0.006)).amplitude)
    folds = [point.value for point in graph.special.values() if point.kind == "fold"]
    found = min(folds, key=lambda value: abs(value - expected), default=math.nan)
    return {
        "passed": bool(abs(found - expected) < Settings.located * expected),
        "found": float(found),
        "closed_form": expected,
    }


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
    """Return the JSON Schema of all kinds of studies: built-in machines, the same in physical units, machines and flows of Python files.

    Returns
    -------
    dict
        JSON Schema of draft 7. Fields, types, limits and defaults are those of the pydantic models. Conditions on two fields at once (a
        start outside its interval) are checked by the commands only.
    """
    from orbits.machines.names import NAMES

    from .schema import FlowSections, PageSections, catalogue_model

    kinds = [_titled(inlined(catalogue_model(name)), f"the machine {name}") for name in NAMES]
    kinds += [schema for schema in map(_physical, NAMES) if schema is not None]
    own = [
        _for_python_files(_with_units(inlined(PageSections)), "a machine of a Python file"),
        _for_python_files(inlined(FlowSections), "a flow of a Python file"),
    ]
    return {
        "$schema": DIALECT,
        "title": "a study of contvines",
        "type": "object",
        "oneOf": [
            *map(_with_conditions, kinds),
            {"title": "what a Python file declares", "anyOf": [*map(_with_conditions, own)]},
        ],
    }


def _titled(schema: dict[str, Any], title: str) -> dict[str, Any]:
    sections = {"model": schema["properties"].pop("model") | {"title": title}, **schema["properties"]}
    return schema | {"title": title, "properties": sections}


def _with_conditions(schema: dict[str, Any]) -> dict[str, Any]:
    """Extend the schema of a study by parameters that are tables over a condition."""
    row = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2}
    table = {
        "type": "object",
        "description": "a table over one condition, for example { temperature = [[20, 0.7], [80, 0.6]] }",
        "additionalProperties": {"type": "array", "items": row, "minItems": 2},
        "minProperties": 1,
        "maxProperties": 1,
    }
    model = schema["properties"]["model"]
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
    sections = {**schema["properties"], "model": model | {"properties": entries}, "conditions": conditions}
    return schema | {"properties": sections}


def _physical(name: str) -> dict[str, Any] | None:
    """Return the schema of a machine in physical units, whose quantities are texts with a unit; None for a machine without quantities."""
    from pydantic import Field

    from orbits.machines.names import model_class
    from orbits.machines.physical.machine import CONTACT, tables
    from orbits.machines.physical.quantities import QuantityError

    from .schema import StudySections, study_model

    try:
        quantities = tables(model_class(name)).quantities
    except QuantityError:
        return None
    fields: dict[str, Any] = {
        key: Annotated[
            (str | Literal[0] if entry.zero or entry.signed else str) if entry.unit else str | float,
            Field(description=f"{entry.meaning}; for example {entry.example}"),
        ]
        for key, entry in quantities.items()
    }
    contact = f"{CONTACT.meaning}; for example {CONTACT.example}"
    settings: dict[str, Any] = {
        "name": (Literal[name], ...),  # type: ignore[valid-type]
        "units": (Literal["si"] | None, None),
        "unusual": (Annotated[bool, Field(description="allow sizes that nobody builds")], False),
        **{key: (fields[key] | None, entry.default) for key, entry in quantities.items()},
        CONTACT.name: (Annotated[str | None, Field(description=contact)], None),
    }
    schema = _with_units(inlined(study_model(StudySections, settings, fields)))
    in_si = {"required": ["units"]}
    return _titled(schema, f"the machine {name} in physical units") | {
        "anyOf": [in_si, {"properties": {"model": in_si}}]
    }


def _for_python_files(schema: dict[str, Any], title: str) -> dict[str, Any]:
    """Restrict a schema to studies of a Python file, by the form of the model's name; the parameters are known only after the file has run."""
    from orbits.machines.names import PAGES, STRUCTURE

    meaning = f'a file beside the study, and the machine or flow in it: "file.py:name"; or one that comes with the package: {", ".join([STRUCTURE, *PAGES])}'
    name = {"type": "string", "pattern": "|".join([r"\.py", STRUCTURE, *PAGES]), "description": meaning}
    schema["properties"]["model"] = {"type": "object", "properties": {"name": name}, "required": ["name"]}
    schema["properties"]["start"]["additionalProperties"] = True
    return schema | {"title": title, "required": ["model", *schema["required"]]}


def inlined(model: type[BaseModel]) -> dict[str, Any]:
    """Return the schema of a pydantic model with references resolved, and without null, which TOML lacks."""
    schema = model.model_json_schema(by_alias=True)
    shared = schema.pop("$defs", {})

    def resolved(value: Any) -> Any:
        if isinstance(value, list):
            return [resolved(entry) for entry in value]
        if not isinstance(value, dict):
            return value
        entries = {k: resolved(v) for k, v in value.items() if not _is_redundant(k, v)}
        if "$ref" in entries:
            entries = resolved(shared[entries.pop("$ref").rpartition("/")[2]]) | entries
        choices = [entry for entry in entries.get("anyOf", ()) if entry != {"type": "null"}]
        if len(choices) == 1:
            entries = choices[0] | {k: v for k, v in entries.items() if k != "anyOf"}
        elif choices:
            entries["anyOf"] = choices
        return entries

    return resolved(schema)


def _is_redundant(key: str, value: object) -> bool:
    """Whether an entry is useless in an editor: titles made from names, defaults that are None or whole sections."""
    return (key == "title" and isinstance(value, str)) or (
        key == "default" and (value is None or isinstance(value, dict))
    )


def _with_units(schema: dict[str, Any]) -> dict[str, Any]:
    """Allow ``units = "si"`` in the schema of a study, and texts with a unit in all its lists of numbers, except in guesses."""

    def extended(value: Any) -> Any:
        if isinstance(value, list):
            return [extended(entry) for entry in value]
        if not isinstance(value, dict):
            return value
        if value.get("items") == {"type": "number"}:
            return value | {"items": {"type": ["number", "string"]}}
        return {k: v if k == "guess" else extended(v) for k, v in value.items()}

    return extended(schema | {"properties": schema["properties"] | {"units": {"const": "si"}}})
