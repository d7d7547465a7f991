"""`contvines new`: a commented study to begin with."""

from __future__ import annotations

from enum import StrEnum
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from contvines.command.options import argument, option
from contvines.file_names import refuse_ending, refuse_place


class Kind(StrEnum):
    """What `new` writes."""

    absorber = "absorber"
    coupled = "coupled"
    cavity = "cavity"
    si = "si"
    machine = "machine"
    flow = "flow"


BESIDE = {Kind.machine: "machine.py", Kind.flow: "flow.py"}
"""Python files that a study names and that are written beside it."""


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
        own = f"{target.stem}.py"
        texts[target] = texts[target].replace(name, own)
        texts[target.with_name(own)] = _template(name)
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
