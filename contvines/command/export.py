"""`contvines export`: a stored graph for other programs."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from contvines.command.frame import beside, say, say_state
from contvines.command.options import FileArgument, TrustOption, option


class Format(StrEnum):
    """What `export` writes."""

    csv = "csv"
    json = "json"
    graphml = "graphml"
    mat = "mat"
    latex = "latex"
    auto = "auto"
    xpp = "xpp"


def export(
    file: FileArgument,
    to: Annotated[Format | None, option("--to", "The format; by default that of the output's name.")] = None,
    output: Annotated[
        Path | None,
        option("-o, --output PATH", "Where to; by default FILE.FORMAT here."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Write a result for other programs: csv, json, graphml, mat, latex, auto or xpp.

    csv has a row per point of every branch: the unknowns u0, u1 ..., then
    multipliers, word, periods and all measures (empty where not defined).
    mat has the same, a struct per branch; json and graphml are summaries,
    latex tables of branches and special points for booktabs. auto writes
    b.NAME, s.NAME and d.NAME as AUTO-07p does, xpp the points of a diagram of
    XPPAUT.

    The unknowns follow the events in the word's order: at an impact the
    forcing's phase (radians) and the absorber's velocity after it (times
    1 + mass ratio, as B_post); at a turn, a stick and its slip the phase and
    the displacement w. In the coupled machine v and v_rate follow each pair.
    A symmetric branch has those of the first half of its word; the other half
    is their mirror image. The stuck absorber has no events: its u are the
    oscillator's sine and cosine (0 in the reduced machine).
    """
    from contvines.export import ENDINGS, check_target
    from contvines.export import export as write

    if to is None:
        ending = output.suffix.removeprefix(".") if output is not None else ""
        ending = next((form for form, own in ENDINGS.items() if own == ending), ending)
        if ending not in Format.__members__:
            raise typer.BadParameter(
                "the format is missing: --to csv, or a name that tells it, -o results.csv; formats are "
                + ", ".join(Format)
            )
        to = Format(ending)
    ending = ENDINGS.get(to.value, to.value)
    target = output or beside(file, f".{ending}")
    if to is not Format.auto:
        check_target(target, to.value if target.suffix == f".{to.value}" else ending)
    measures = to in (Format.csv, Format.mat, Format.auto, Format.xpp)
    from contvines.loci.chart import Chart
    from contvines.store import load

    graph = load(file, problems=measures, trust=trust)
    if isinstance(graph, Chart):
        from contvines.export.files import export_chart

        typer.echo(str(export_chart(graph, to.value, target)))
        return
    say_state(graph, file, measures)
    typer.echo(str(write(graph, to.value, target)))
    if to is Format.auto and any(
        branch.problem is None and "cycle" in branch.description for branch in graph.branches.values()
    ):
        say(f"the file of solutions has no cycles: {file} names Python code, which --trust would run")
