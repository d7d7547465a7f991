"""Options that several commands share."""

from typing import Annotated

import typer

TrustOption = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Import Python functions that the file names: runs their code, so only for files whose maker you trust.",
    ),
]
