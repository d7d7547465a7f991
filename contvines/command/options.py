"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

StudyArgument = Annotated[
    Path, typer.Argument(metavar="STUDY.toml", help="The study: model, start, what to continue.")
]
FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE.vines", help="A file that diagram or trace has made.")
]
LabelArgument = Annotated[str, typer.Argument(metavar="LABEL", help="A special point, for example SB1.")]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw the result (png, pdf or svg).")
]
SizeOption = Annotated[
    tuple[float, float] | None,
    typer.Option(
        "--size", metavar="WIDTH HEIGHT", help="Of the picture, in inches; 3.4 2.4 is a column of a journal."
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")]
FreshOption = Annotated[
    bool,
    typer.Option(
        "--fresh", help="Begin anew: a file that is there is set aside, FILE.vines as FILE.old.vines."
    ),
]
TrustOption = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Import Python functions that the file names: runs their code, so only for files whose maker you trust.",
    ),
]
VirtualOption = Annotated[
    bool, typer.Option("--virtual", help="Go on where no machine follows the motion; drawn dotted.")
]
CompareOption = Annotated[
    list[str] | None,
    typer.Option(
        "--compare",
        metavar="KIND",
        help="With a picture of responses: bare, tuned or friction; may be repeated.",
    ),
]
