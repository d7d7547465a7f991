"""`contvines circle`: the invariant circles beside a Neimark-Sacker point."""

from typing import Annotated

from contvines.command.amounts import amount
from contvines.command.frame import draw, load_file, refuse_detached, tell
from contvines.command.options import (
    FileArgument,
    JsonOption,
    PlotOption,
    SizeOption,
    TrustOption,
    argument,
    option,
)


def circle(
    file: FileArgument,
    label: Annotated[str, argument("LABEL", "A Neimark-Sacker point, for example NS1.")],
    to: Annotated[
        str | None,
        option(
            "--to VALUE",
            "Last value of the parameter; by default where the circle is half as large as the motion.",
        ),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow the invariant circles (modulated motions) of a Neimark-Sacker point until they break up."""
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
