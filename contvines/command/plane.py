"""What `contvines locus` and `contvines chart` share: options of the plane of two parameters, refusals, and what is told at the end."""

from pathlib import Path
from typing import Annotated, Any

import typer

PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw the plane of the two parameters.")
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no table.")]
VirtualOption = Annotated[
    bool, typer.Option("--virtual", help="Go on where no machine follows the motion; drawn dotted.")
]


def check(plot: Path | None, target: Path, source: Path) -> None:
    """Refuse a place that will not do, before any work."""
    if target.resolve() == source.resolve():
        raise ValueError(f"{target}: this is the file itself; choose another name with -o.")
    if plot is not None:
        from contvines.plots.figures import check_picture

        check_picture(plot)


def refuse_charts(graph: Any, file: Path) -> None:
    """A diagram is needed, no chart."""
    if not hasattr(graph, "special"):
        raise ValueError(f"{file}: this file holds a chart; give one that `contvines diagram` has made.")


def tell(found: Any, target: Path, plot: Path | None, quiet: bool) -> None:
    """Say where a chart is kept, print it, draw it."""
    from contvines.command.compose import say

    say(f"kept in {target}", quiet)
    if not quiet:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.chart import plot_chart
        from contvines.plots.figures import save_figure

        save_figure(plot_chart(found), plot)
        say(f"drawn in {plot}", quiet)
