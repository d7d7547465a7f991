"""`contvines circle`: the invariant circles beside a Neimark-Sacker point."""

from pathlib import Path
from typing import Annotated

import typer

from contvines.command.amounts import amount
from contvines.command.options import FileArgument, SizeOption, TrustOption
from contvines.command.stored import refuse_detached


def circle(
    file: FileArgument,
    label: Annotated[str, typer.Argument(metavar="LABEL", help="A Neimark-Sacker point, for example NS1.")],
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="VALUE", help="Parameter value to go to; by default half the size of the motion."
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE.png", help="Draw section, radius and rotation number."),
    ] = None,
    size: SizeOption = None,
    json: Annotated[bool, typer.Option("--json", help="One JSON object instead of a table.")] = False,
    trust: TrustOption = False,
) -> None:
    """Follow the modulated motions that are born at a Neimark-Sacker point until they break."""
    from contvines.store import load

    if plot is not None:
        from contvines.plots.figures import check_picture, check_size

        check_picture(plot)
        check_size(size)
    graph = load(file, trust=trust)
    special = getattr(graph, "special", {})
    if label not in special:
        known = ", ".join(name for name, point in special.items() if point.kind == "neimark-sacker")
        raise ValueError(
            f"{file}: {label} is no label of it; its Neimark-Sacker points are {known or 'none'}."
        )
    refuse_detached(graph, [label])
    found = special[label].circles(None if to is None else amount("--to", to, graph.parameter, graph.units))
    if json:
        import json as text

        typer.echo(text.dumps(found.to_dict()))
    else:
        typer.echo(str(found))
    if plot is not None:
        from contvines.plots.figures import save_figure

        save_figure(found.plot(figsize=size), plot)
        if not json:
            typer.echo(f"drawn in {plot}")
