"""Options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE.vines", help="A file that diagram or trace has made.")
]

TrustOption = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Import Python functions that the file names: runs their code, so only for files whose maker you trust.",
    ),
]

JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")]

SizeOption = Annotated[
    tuple[float, float] | None,
    typer.Option(
        "--size", metavar="WIDTH HEIGHT", help="Of the picture, in inches; 3.4 2.4 is a column of a journal."
    ),
]

FreshOption = Annotated[
    bool,
    typer.Option(
        "--fresh", help="Begin anew: a file that is there is set aside, FILE.vines as FILE.old.vines."
    ),
]
