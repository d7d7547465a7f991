"""Arguments and options common to several commands, their declaration, and the parsing of parameter values (numbers or quantities)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperOption


def option(usage: str, help: str, **further: Any) -> Any:
    """Declare an option of a command.

    Parameters
    ----------
    usage : str
        Its names and its value as the help shows them, for example ``"-o, --output FILE.csv"``.
    help : str
    **further
        Arguments of `typer.Option`.
    """
    words = usage.split()
    names = [word.rstrip(",") for word in words if word.startswith("-")]
    return typer.Option(*names, metavar=" ".join(words[len(names) :]) or None, help=help, **further)


def argument(metavar: str, help: str) -> Any:
    """Declare an argument of a command; `metavar` is its name in the help."""
    return typer.Argument(metavar=metavar, help=help)


def given(context: typer.Context) -> dict[str, str]:
    """Return the options that were given with other values than their defaults, as written on the command line, and their values."""
    found = {}
    for entry in context.command.params:
        value = context.params.get(str(entry.name))
        if isinstance(entry, TyperOption) and value not in (entry.default, (), []):
            name = entry.secondary_opts[0] if value is False else entry.opts[-1]
            values = [] if entry.is_flag else value if isinstance(value, tuple | list) else [value]
            found[name] = " ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in (name, *values))
    return found


def refuse_alone(context: typer.Context, **needed: str) -> None:
    """Raise an error for options that need another option which is missing.

    Parameters
    ----------
    context : typer.Context
    **needed : str
        Name of an option without its dashes -> the option that it needs.

    Raises
    ------
    ValueError
    """
    line = given(context)
    for name, other in needed.items():
        if f"--{name}" in line and other not in line:
            raise ValueError(
                f"{line[f'--{name}']}: this goes with {other}; give {other}, too, or leave --{name} out."
            )


def picture(path: Path | None) -> Path | None:
    """Check, before any work and without matplotlib, that a picture can be written; return its path."""
    if path is not None:
        from ..plots.figures import check_picture

        check_picture(path)
    return path


def inches(size: tuple[float, float] | None) -> tuple[float, float] | None:
    """Check, before any work, that width and height of a picture are between 1 and 60 inches; return them."""
    if size is not None and not all(1.0 <= side <= 60.0 for side in size):
        raise ValueError(f"--size {size[0]:g} {size[1]:g}: give inches between 1 and 60, such as 3.4 2.4.")
    return size


StudyArgument = Annotated[Path, argument("STUDY.toml", "A study: model, start, what to continue.")]
FileArgument = Annotated[
    Path, argument("FILE.vines", "A result: a .vines file of diagram, atlas, trace or chart.")
]
LabelArgument = Annotated[str, argument("LABEL", "A special point, for example SB1.")]
PlotOption = Annotated[
    Path | None, option("--plot FILE.png", "Draw the result (png, pdf or svg).", callback=picture)
]
SizeOption = Annotated[
    tuple[float, float] | None,
    option(
        "--size WIDTH HEIGHT",
        "Size of the picture in inches; 3.4 2.4 fits one column of a journal.",
        callback=inches,
    ),
]
QuietOption = Annotated[bool, option("--quiet, -q", "No progress, no table.")]
JsonOption = Annotated[bool, option("--json", "Print one JSON object with all digits.")]
FreshOption = Annotated[
    bool,
    option(
        "--fresh", "Begin again; an existing result is renamed, for example FILE.vines to FILE.old.vines."
    ),
]
MANY = 30  # number of branches or loci above which only a summary of a result is printed
DetailsOption = Annotated[
    bool,
    option("--details", f"Print the whole tables, even if there are more than {MANY} branches (or loci)."),
]
TrustOption = Annotated[
    bool,
    option("--trust", "Run the Python code that the file names; only for files from people you trust."),
]
VirtualOption = Annotated[
    bool,
    option("--virtual", "Also continue virtual motions, which no real machine follows; drawn dotted."),
]


class Beside(StrEnum):
    """Machines with which a response is compared, as in `orbits.design.references`."""

    bare = "bare"
    tuned = "tuned"
    friction = "friction"


CompareOption = Annotated[
    list[Beside] | None,
    option(
        "--compare KIND",
        "Draw another response beside: bare (no absorber), tuned (mass damper) or friction (damper); repeatable.",
    ),
]
XOption = Annotated[str | None, option("-x", "Measure on the x axis; by default the parameter.")]
YOption = Annotated[
    str | None,
    option(
        "-y",
        "Measure on the y axis; by default B (velocity at the first impact), max_abs_q1 of the coupled machine, else the first measure of the problem (`contvines plot FILE.vines --help` says which).",
    ),
]


def amount(option: str, text: str, name: str, units: Mapping[str, str]) -> float:
    """Parse a value of a parameter and convert it to the file's unit.

    Parameters
    ----------
    option : str
        Option with which it was given, for error messages.
    text : str
        ``"7.9"``, or ``"7.9 Hz"`` if the parameter has a unit.
    name : str
        Of the parameter.
    units : mapping
        Units of parameters by name, without those of plain numbers.

    Raises
    ------
    ValueError
        If the text is neither; the message suggests a remedy.
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
    """Parse a value of a parameter, which must lie in the interval of a study or a file.

    Parameters
    ----------
    option, text, name, units
        As for `amount`.
    within : (float, float)
        The interval.
    owner : str
        Name of the interval for error messages, for example ``"[continue] within"``.

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
    """Parse both ends of an interval, the lower one first.

    Raises
    ------
    ValueError
        As `amount`, or if the interval is empty or reversed.
    """
    low, high = (amount(option, text, name, units) for text in ends)
    if not low < high:
        given_ends = " ".join(repr(text) if " " in text else text for text in ends)
        raise ValueError(f"{option} {given_ends}: give the lower value first, then the higher one.")
    return low, high
