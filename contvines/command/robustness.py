"""`contvines robustness`: how far a stable motion is from being lost."""

from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.amounts import inside
from contvines.command.options import FileArgument, SizeOption, TrustOption


def robustness(
    file: FileArgument,
    label: Annotated[
        str, typer.Argument(metavar="LABEL", help="A branch (B1), or one of its stable points (B1:12).")
    ],
    at: Annotated[
        str | None, typer.Option("--at", metavar="VALUE", help="Of a branch, the value of its parameter.")
    ] = None,
    values: Annotated[
        int, typer.Option("--values", min=1, help="Of a whole branch, how many values of its stable part.")
    ] = 16,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="NAME", help="Also the stable interval of this parameter (repeatable)."
        ),
    ] = None,
    starts: Annotated[
        int, typer.Option("--starts", min=1, help="Starts that tell the share of the basin.")
    ] = 1024,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the starts.")] = 0,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw the erosion curve of a branch.")
    ] = None,
    size: SizeOption = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object, numbers at full precision.")
    ] = False,
    trust: TrustOption = False,
) -> None:
    """The smallest kick that makes a stable motion go elsewhere, and the share of starts that reach it.

    With a branch alone, both against its parameter: an erosion curve.
    """
    import contvines
    from contvines.problems.registry import without_problem
    from contvines.store import load

    if plot is not None:
        from contvines.plots.figures import check_picture, check_size

        check_picture(plot)
        check_size(size)
    graph = load(file, trust=trust)
    name, _, place = label.partition(":")
    branches = getattr(graph, "branches", {})
    if name not in branches:
        raise ValueError(f"{file}: {name} is no branch of it; it has {', '.join(branches) or 'none'}.")
    branch = branches[name]
    if branch.problem is None:
        raise ValueError(without_problem(name, branch.description))
    value: float | None = None
    if at is not None:
        value = inside("--at", at, graph.parameter, graph.within, graph.units, f"the interval of {file}")
    if place:
        if not place.isdigit() or int(place) >= len(branch):
            raise ValueError(f"{label}: the points of {name} are numbered from 0 to {len(branch) - 1}.")
        value = float(branch.values[int(place)])
    if plot is not None and value is not None:
        raise ValueError("--plot draws the erosion curve of a whole branch: leave out --at and the point.")
    found: Any
    if value is None:
        if vary:
            raise ValueError("--vary needs one motion: give a point (B1:12), or --at VALUE.")
        found = contvines.erosion(branch, values, starts=starts, seed=seed)
    else:
        found = contvines.robustness(branch, value, starts=starts, seed=seed, vary=tuple(vary or ()))
    if json:
        from contvines.export import json_text

        typer.echo(json_text(found.to_dict()))
    else:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.figures import save_figure

        save_figure(found.plot(figsize=size), plot)
        if not json:
            typer.echo(f"drawn in {plot}")
