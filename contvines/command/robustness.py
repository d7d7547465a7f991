"""`contvines robustness`: how far a stable motion is from being lost."""

from typing import Annotated

from contvines.command.amounts import inside
from contvines.command.frame import draw, load_file, tell
from contvines.command.options import (
    FileArgument,
    JsonOption,
    PlotOption,
    SizeOption,
    TrustOption,
    argument,
    option,
)


def robustness(
    file: FileArgument,
    label: Annotated[str, argument("LABEL", "A branch (B1), or one of its stable points (B1:12).")],
    at: Annotated[str | None, option("--at VALUE", "With a branch: the value of its parameter.")] = None,
    values: Annotated[
        int, option("--values", "With a branch: number of values on its stable part.", min=1)
    ] = 16,
    vary: Annotated[
        list[str] | None,
        option(
            "--vary NAME",
            "Also find the interval of this parameter in which the motion is stable (repeatable).",
        ),
    ] = None,
    starts: Annotated[
        int | None,
        option(
            "--starts",
            "Number of starts for the share of the basin; by default 1024, for declared machines 256.",
            min=1,
        ),
    ] = None,
    seed: Annotated[int, option("--seed", "Seed of the random starts.", min=0)] = 0,
    plot: PlotOption = None,
    size: SizeOption = None,
    json: JsonOption = False,
    trust: TrustOption = False,
) -> None:
    """Robustness of a stable motion: the smallest kick out of its basin, the share of its basin.

    With a branch alone, both against its parameter: an erosion curve.
    """
    import contvines
    from contvines.problems.registry import without_problem

    graph = load_file(file, trust)
    name, _, place = label.partition(":")
    branches = graph.branches
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
    if value is not None:
        found = contvines.robustness(branch, value, starts=starts, seed=seed, vary=tuple(vary or ()))
        tell(found, found.to_dict() if json else None)
        return
    if vary:
        raise ValueError("--vary needs one motion: give a point (B1:12), or --at VALUE.")
    curve = contvines.erosion(branch, values, starts=starts, seed=seed)
    tell(curve, curve.to_dict() if json else None)
    draw(plot, lambda: curve.plot(figsize=size), json)
