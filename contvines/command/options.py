"""Arguments and options that several verbs share, and how one is written: as its line in the help."""

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
        from contvines.plots.figures import check_picture

        check_picture(path)
    return path


def inches(size: tuple[float, float] | None) -> tuple[float, float] | None:
    """Refuse, before any work, a size that is no picture's."""
    if size is not None:
        from contvines.plots.figures import check_size

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
CompareOption = Annotated[
    list[str] | None,
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
