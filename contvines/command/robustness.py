"""`contvines robustness` and `basins`: robustness of stable motions, and basins of attraction."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from .frame import load_file, point_of, present
from .options import (
    FileArgument,
    JsonOption,
    PlotOption,
    SizeOption,
    StudyArgument,
    TrustOption,
    argument,
    inside,
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

    from ..problems.registry import without_problem

    graph = load_file(file, trust)
    name = label.partition(":")[0]
    if name not in graph.branches:
        raise ValueError(f"{file}: {name} is no branch of it; it has {', '.join(graph.branches) or 'none'}.")
    branch, place = point_of(graph, label)
    if branch.problem is None:
        raise ValueError(without_problem(name, branch.description))
    value = None if place is None else float(branch.values[place])
    if at is not None:
        inside_value = inside(
            "--at", at, graph.parameter, graph.within, graph.units, f"the interval of {file}"
        )
        value = inside_value if value is None else value
    if plot is not None and value is not None:
        raise ValueError("--plot draws the erosion curve of a whole branch: leave out --at and the point.")
    if value is None:
        if vary:
            raise ValueError("--vary needs one motion: give a point (B1:12), or --at VALUE.")
        present(contvines.erosion(branch, values, starts=starts, seed=seed), json, plot, size)
    else:
        found = contvines.robustness(branch, value, starts=starts, seed=seed, vary=tuple(vary or ()))
        present(found, json, None, None)


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

    from .compose import population
    from .study import read_study

    asked = read_study(study)
    starts = population(asked)
    units = getattr(starts, "units", {})
    value = inside("--at", at, asked.parameter, asked.within, units, f"{study}: [continue] within")
    graph = None if saddles is None else load_file(saddles)
    found = contvines.basins(starts, at=value, plane=plane, points=points, saddles=graph)
    present(found, json, plot, size)
