"""`contvines circle`: the invariant circles beside a Neimark-Sacker point."""

from typing import Annotated

import typer

from contvines.command.amounts import amount
from contvines.command.frame import (
    FileArgument,
    JsonOption,
    PlotOption,
    SizeOption,
    TrustOption,
    check_plot,
    draw,
    load_file,
    refuse_detached,
    tell,
)


def circle(
    file: FileArgument,
    label: Annotated[str, typer.Argument(metavar="LABEL", help="A Neimark-Sacker point, for example NS1.")],
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            metavar="VALUE",
            help="Last value of the parameter; by default where the circle is half as large as the motion.",
        ),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow the invariant circles (modulated motions) of a Neimark-Sacker point until they break up."""
    check_plot(plot, size)
    graph = load_file(file, trust)
    special = graph.special
    if label not in special:
        known = ", ".join(name for name, point in special.items() if point.kind == "neimark-sacker")
        raise ValueError(
            f"{file}: {label} is no label of it; its Neimark-Sacker points are {known or 'none'}."
        )
    refuse_detached(graph, label)
    found = special[label].circles(None if to is None else amount("--to", to, graph.parameter, graph.units))
    tell(found, found.to_dict() if json else None)
    draw(plot, lambda: found.plot(figsize=size), json)
