"""`contvines basins`: which start reaches which motion."""

from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.run import StudyArgument

ENDS = {
    "leaves": "leaves the plane",
    "long": "cut where it was very long",
    "breaks": "cut where the motion is not continuous",
}


def basins(
    study: StudyArgument,
    at: Annotated[float, typer.Option("--at", metavar="VALUE", help="Value of the study's parameter.")],
    plane: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--plane", metavar="X Y", help="The two coordinates of the starts; by default w w_rate."
        ),
    ] = None,
    points: Annotated[int, typer.Option("--points", help="Starts across and up.")] = 200,
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
    size: Annotated[
        tuple[float, float] | None, typer.Option("--size", metavar="WIDTH HEIGHT", help="Inches.")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")
    ] = False,
) -> None:
    """Basins of attraction in a plane of starts, their shares and their boundary's exponent."""
    import contvines
    from contvines.coexistence.population import population_of
    from contvines.command.compose import checked_study, loose, machine, say

    if plot is not None:
        from contvines.plots.figures import check_picture

        check_picture(plot)
    asked = checked_study(study)
    fixed = {name: value for name, value in loose(asked).items() if name != asked.parameter}
    population = population_of(machine(asked), asked.parameter, **fixed)
    graph: Any = None if saddles is None else contvines.load(saddles)
    found = contvines.basins(population, at=at, plane=plane, points=points, saddles=graph)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(found.to_dict()))
    else:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.figures import check_picture

        check_picture(plot)
    asked = checked_study(study)
    fixed = {name: value for name, value in loose(asked).items() if name != asked.parameter}
    population = population_of(machine(asked), asked.parameter, **fixed)
    found = contvines.basins(population, at=at, plane=plane, points=points)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(found.to_dict()))
    else:
        across, up = found.axes
        typer.echo(f"{found.index.size} starts in the plane {across}, {up} at {found.parameter} = {at:.10g}")
        for k, about in enumerate(found.attractors):
            low, high = found.interval(k)
            word = about.name
            images = f", {about.mirror_share:.1%} of them the mirror image" if about.mirror_share else ""
            typer.echo(f"  {word}  k={about.periods}  {about.share:.2%} ({low:.2%} to {high:.2%}{images})")
        try:
            exponent, error = found.uncertainty_exponent()
            typer.echo(f"  uncertainty exponent of the boundary: {exponent:.2f} +- {error:.2f}")
        except ValueError:
            pass
        for curve in found.manifolds:
            typer.echo(
                f"  stable manifold of {curve.word} on {curve.branch}: {len(curve.points)} points, {ENDS[curve.ended]}"
            )
    if plot is not None:
        from contvines.plots.figures import save_figure

        save_figure(found.plot(figsize=size), plot)
        say(f"drawn in {plot}")
