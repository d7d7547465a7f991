"""`contvines basins`: which start reaches which motion."""

from pathlib import Path
from typing import Annotated

from contvines.command.amounts import inside
from contvines.command.frame import draw, load_file, tell
from contvines.command.options import JsonOption, PlotOption, SizeOption, StudyArgument, option


def basins(
    study: StudyArgument,
    at: Annotated[str, option("--at VALUE", "Value of the study's parameter.")],
    plane: Annotated[
        tuple[str, str] | None,
        option("--plane X Y", "Two states that vary; by default the first position and its rate."),
    ] = None,
    points: Annotated[
        int | None,
        option("--points", "Starts per axis; by default 200, for declared machines 60."),
    ] = None,
    saddles: Annotated[
        Path | None,
        option("--saddles FILE.vines", "Also draw the stable manifolds of this graph's unstable motions."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
) -> None:
    """Basins of attraction in a plane of starts: shares, uncertainty exponent of the boundary."""
    import contvines
    from contvines.command.compose import population
    from contvines.command.study import read_study

    asked = read_study(study)
    starts = population(asked)
    units = getattr(starts, "units", {})
    value = inside("--at", at, asked.parameter, asked.within, units, f"{study}: [continue] within")
    graph = None if saddles is None else load_file(saddles)
    found = contvines.basins(starts, at=value, plane=plane, points=points, saddles=graph)
    tell(found, found.to_dict() if json else None)
    draw(plot, lambda: found.plot(figsize=size))
