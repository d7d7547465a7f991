"""`contvines basins`: which start reaches which motion."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from contvines.command.amounts import inside
from contvines.command.frame import (
    JsonOption,
    PlotOption,
    SizeOption,
    StudyArgument,
    check_plot,
    draw,
    load_file,
    tell,
)

if TYPE_CHECKING:
    pass


def basins(
    study: StudyArgument,
    at: Annotated[str, typer.Option("--at", metavar="VALUE", help="Value of the study's parameter.")],
    plane: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--plane",
            metavar="X Y",
            help="Two states that vary; by default the first position and its rate.",
        ),
    ] = None,
    points: Annotated[
        int | None,
        typer.Option("--points", help="Starts per axis; by default 200, for declared machines 60."),
    ] = None,
    saddles: Annotated[
        Path | None,
        typer.Option(
            "--saddles",
            metavar="FILE.vines",
            help="Also draw the stable manifolds of this graph's unstable motions.",
        ),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
) -> None:
    """Basins of attraction in a plane of starts: shares, uncertainty exponent of the boundary."""
    import contvines
    from contvines.command.compose import population
    from contvines.command.study import read_study

    check_plot(plot, size)
    asked = read_study(study)
    starts = population(asked)
    units = getattr(starts, "units", {})
    value = inside("--at", at, asked.parameter, asked.within, units, f"{study}: [continue] within")
    graph = None if saddles is None else load_file(saddles)
    found = contvines.basins(starts, at=value, plane=plane, points=points, saddles=graph)
    tell(found, found.to_dict() if json else None)
    draw(plot, lambda: found.plot(figsize=size))
