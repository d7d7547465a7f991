"""`contvines basins`: which start reaches which motion."""

from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.amounts import inside
from contvines.command.options import SizeOption
from contvines.command.run import StudyArgument


def basins(
    study: StudyArgument,
    at: Annotated[str, typer.Option("--at", metavar="VALUE", help="Value of the study's parameter.")],
    plane: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--plane",
            metavar="X Y",
            help="The two coordinates of the starts; by default the first position and its rate.",
        ),
    ] = None,
    points: Annotated[
        int | None,
        typer.Option("--points", help="Starts across and up; by default 200, of machines on a page 60."),
    ] = None,
    saddles: Annotated[
        Path | None,
        typer.Option(
            "--saddles",
            metavar="FILE.vines",
            help="Grow the stable manifolds of this graph's unstable motions.",
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw the plane in colours.")
    ] = None,
    size: SizeOption = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")
    ] = False,
) -> None:
    """Basins of attraction in a plane of starts, their shares and their boundary's exponent."""
    import contvines
    from contvines.command.compose import checked_study, population, say

    if plot is not None:
        from contvines.plots.figures import check_picture, check_size

        check_picture(plot)
        check_size(size)
    asked = checked_study(study)
    starts = population(asked)
    units = getattr(starts, "units", {})
    value = inside("--at", at, asked.parameter, asked.within, units, f"{study}: [continue] within")
    graph: Any = None if saddles is None else contvines.load(saddles)
    found = contvines.basins(starts, at=value, plane=plane, points=points, saddles=graph)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(found.to_dict()))
    else:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.figures import save_figure

        save_figure(found.plot(figsize=size), plot)
        say(f"drawn in {plot}")
