"""`contvines locus`: one special point followed in a second parameter."""

from pathlib import Path
from typing import Annotated

import typer

from contvines.command.amounts import interval
from contvines.command.options import FileArgument, FreshOption, TrustOption
from contvines.command.place import held
from contvines.command.plane import PlotOption, QuietOption, VirtualOption, check, refuse_charts, tell
from contvines.command.stored import refuse_detached

OverOption = Annotated[str, typer.Option("--over", metavar="NAME", help="The second parameter.")]
WithinOption = Annotated[
    tuple[str, str],
    typer.Option(
        "--within", metavar="LOW HIGH", help="Its interval: numbers, or quantities as '0.1 mm' '0.6 mm'."
    ),
]


def locus(
    file: FileArgument,
    label: Annotated[str, typer.Argument(metavar="LABEL", help="A special point, for example SB1.")],
    over: OverOption,
    within: WithinOption,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE.vines", help="Where to keep it; by default FILE-LABEL.vines here."
        ),
    ] = None,
    plot: PlotOption = None,
    fresh: FreshOption = False,
    virtual: VirtualOption = False,
    quiet: QuietOption = False,
    trust: TrustOption = False,
) -> None:
    """Follow one special point of a result in a second parameter.

    The locus ends with either interval: that of the diagram, and --within.
    """
    from contvines.command.compose import beside, check_place
    from contvines.store import load

    target = output or beside(file, f"-{label}.vines")
    check_place(target)
    check(plot, target, file)
    graph = load(file, trust=trust)
    refuse_charts(graph, file)
    if label not in graph.special:
        what = "is a branch" if label in graph.branches else "is no label of it"
        raise ValueError(
            f"{file}: {label} {what}; its special points are {', '.join(graph.special) or 'none'}."
        )
    refuse_detached(graph, [label])
    ends = interval("--within", within, over, graph.units)
    from contvines.loci.charting import chart_of_one
    from contvines.progress import shown

    with shown(not quiet) as progress:
        found = chart_of_one(graph, label, over, ends, virtual=virtual, progress=progress)
    with held(target, quiet, fresh):
        found.save(target)
    tell(found, target, plot, quiet)
