"""`contvines rerun`: a result computed again from the study that its file keeps, and what differs."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from contvines.command.chart import Plane, chart_of
from contvines.command.frame import held, place_of, refuse_unfinished, say, tell
from contvines.command.kept_study import kept_study
from contvines.command.options import FileArgument, FreshOption, JsonOption, QuietOption, TrustOption, option
from contvines.command.run import graph_of

if TYPE_CHECKING:
    from contvines.graph.graph import Graph
    from contvines.loci.chart import Chart

OutputOption = Annotated[
    Path | None,
    option("-o, --output FILE.vines", "Result file; by default FILE-rerun.vines in this folder."),
]


def rerun(
    file: FileArgument,
    output: OutputOption = None,
    fresh: FreshOption = False,
    quiet: QuietOption = False,
    json: JsonOption = False,
    trust: TrustOption = False,
) -> None:
    """Compute a result again from the study that its file keeps, and list what differs.

    The new result is kept in FILE-rerun.vines; FILE.vines stays as it is.
    Values agree to 1e-10, or to the errors that both results state. Exit
    status 1 if anything differs.
    """
    from contvines.loci.chart import Chart
    from contvines.provenance import as_text, provenance
    from contvines.store import Store, load
    from contvines.store.differences import differences, of_chart, of_graph
    from contvines.store.files import FROM_PYTHON

    before = load(file, problems=False)
    refuse_unfinished(before, file)
    with Store.open(file) as store:
        made, fingerprint, kept = store.made, store.fingerprint, store.study or {}
    if not kept.get("source") and fingerprint == FROM_PYTHON:
        raise ValueError(
            f"{file}: this file keeps no study to run again, as it was saved from Python (graph.save): the script that made it computes it anew. "
            "Files that contvines diagram, atlas and chart write keep theirs; a study may name a flow or a machine in a Python file."
        )
    study, source = kept_study(file, kept.get("source"), trust)
    target = place_of(output, file, "-rerun.vines")
    command = source["command"]
    if command == "atlas" and not isinstance(before, Chart) and "budget" in before.settings:
        study = study.with_budget(before.settings["budget"])  # it may have gone on with a larger one
    with held(target, quiet, fresh or _finished(target)):
        if isinstance(before, Chart):
            diagram = target.with_name(f"{target.stem}-diagram.vines")
            with held(diagram, quiet, fresh or _finished(diagram)):
                graph = graph_of(study, command, diagram, quiet, problems=True, look=False)
            over, low, high = source["chart"]
            plane = Plane(over, (low, high), source["virtual"])
            after = chart_of(graph, plane, target, quiet, source)
            found = differences(of_chart(before), of_chart(after))
            same = plane.fingerprint(graph) == fingerprint
        else:
            after = graph_of(study, command, target, quiet, problems=False, look=before.looked)
            found = differences(of_graph(before), of_graph(after))
            same = study.fingerprint(command) == fingerprint
    if json:
        tell(None, {"before": made, "after": provenance(), "same_study": same, "differences": found})
    else:
        if not same:
            say("what the study names has changed since: the two results are of different studies.")
        typer.echo("\n".join([_size(after), *(found or ["no differences"])]))
        if not quiet:
            typer.echo(f"before: {as_text(made) or 'made by a version that did not say so'}")
            typer.echo(f"after:  {as_text(provenance())}")
    if found or not same:
        raise typer.Exit(1)


def _finished(target: Path) -> bool:
    """Whether an earlier run has ended there: an unfinished one is gone on with."""
    from contvines.store import Store

    if not target.is_file():
        return False
    with Store.open(target) as store:
        return store.finished


def _size(result: "Graph | Chart") -> str:
    """How much has been compared."""
    from contvines.loci.chart import Chart

    if isinstance(result, Chart):
        return f"{len(result.loci)} loci and {len(result.points)} points of codimension two compared"
    counts = len(result.branches), len(result.special), len(result.switches)
    return "{} branches, {} special points and {} switches compared".format(*counts)
