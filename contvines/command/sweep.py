"""`contvines sweep`: brute-force simulation over the continuation parameter."""

from pathlib import Path
from typing import Annotated

import typer


def sweep(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY.toml", help="The study; its [sweep] section is optional.")
    ],
    down: Annotated[
        bool, typer.Option("--down", help="From the upper end of the interval to the lower.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.csv", help="Where to; by default STUDY.csv here."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw the attractors.")
    ] = None,
    over: Annotated[
        Path | None, typer.Option("--over", metavar="FILE.vines", help="Draw them over these branches.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing.")] = False,
) -> None:
    """Simulate over the parameter, carrying the state on; tell the attractor at each value."""
    raise ValueError("the sweep is not built yet")
