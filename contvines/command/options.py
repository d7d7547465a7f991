"""Arguments and options that several verbs share, how one is written, as its line in the help, and values of parameters on the line: numbers in the file's units, or quantities."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperOption


def option(usage: str, help: str, **further: Any) -> Any:
    """An option of a verb.

    Parameters
    ----------
    usage : str
        Its names and what stands behind them, as in ``"-o, --output FILE.csv"``.
    help : str
    **further
        As of `typer.Option`.
    """
    words = usage.split()
    names = [word.rstrip(",") for word in words if word.startswith("-")]
    return typer.Option(*names, metavar=" ".join(words[len(names) :]) or None, help=help, **further)


def argument(metavar: str, help: str) -> Any:
    """An argument of a verb, and its name in the help."""
    return typer.Argument(metavar=metavar, help=help)


def given(context: typer.Context) -> dict[str, str]:
    """Options of a line that say something else than their defaults, as they are written there, with their values."""
    found = {}
    for known in context.command.params:
        value = context.params.get(str(known.name))
        if isinstance(known, TyperOption) and value not in (known.default, (), []):
            name = known.secondary_opts[0] if value is False else known.opts[-1]
            values = [] if known.is_flag else value if isinstance(value, tuple | list) else [value]
            found[name] = " ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in (name, *values))
    return found


def refuse_alone(context: typer.Context, **needed: str) -> None:
    """Refuse options that go with another one where this one is missing.

    Parameters
    ----------
    context : typer.Context
    **needed : str
        Name of an option without its dashes -> the option that it goes with.

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
    """Refuse, before any work, a picture that could not be written. Kept apart from matplotlib."""
    if path is not None:
        from ..plots.figures import check_picture

        check_picture(path)
    return path


def inches(size: tuple[float, float] | None) -> tuple[float, float] | None:
    """Refuse, before any work, a size that is no picture's."""
    if size is not None:
        from ..plots.figures import check_size

        check_size(size)
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
MANY = 30  # branches or loci; of a larger result a summary is printed alone
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
    """What a response is compared with; as `orbits.design.references` has them."""

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
    """A value of a parameter, counted in the file's unit.

    Parameters
    ----------
    option : str
        With which it was given, for refusals.
    text : str
        ``"7.9"``, or ``"7.9 Hz"`` where the parameter has a unit.
    name : str
        Of the parameter.
    units : mapping
        Units by name of parameter; those without one are missing.

    Raises
    ------
    ValueError
        If it is neither; the sentence says the way out.
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
    """A value of a parameter inside the interval of a study or a file.

    Parameters
    ----------
    option, text, name, units
        As for `amount`.
    within : (float, float)
        The interval.
    owner : str
        The name of the interval, for refusals, as ``"[continue] within"``.

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
    """Both ends of an interval, the lower one first.

    Raises
    ------
    ValueError
        As `amount`, or if the interval is empty or reversed.
    """
    low, high = (amount(option, text, name, units) for text in ends)
    if not low < high:
        shown = " ".join(repr(text) if " " in text else text for text in ends)
        raise ValueError(f"{option} {shown}: give the lower value first, then the higher one.")
    return low, high
