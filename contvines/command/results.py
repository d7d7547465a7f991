"""`contvines show`, `export`, `report` and `rerun`: print a result, write it for other programs or as an HTML page, or compute it again."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .chart import Plane, chart_of
from .frame import beside, held, place_of, refuse_unfinished, say, say_state, tell
from .options import FileArgument, FreshOption, JsonOption, QuietOption, TrustOption, argument, option
from .run import graph_of

if TYPE_CHECKING:
    from ..graph import Graph
    from ..loci.chart import Chart
    from ..report.answer import Answer
    from ..survey.results import Survey


def show(file: FileArgument, json: JsonOption = False) -> None:
    """List branches, special points and switches."""
    from ..journal import as_text
    from ..store import Store, load

    graph = load(file, problems=False)
    with Store.open(file) as store:
        provenance = store.made
    if json:
        tell(graph, {**graph.to_dict(), "made": provenance})
        return
    say_state(graph, file, problems=False)
    typer.echo(str(graph))
    if provenance:
        typer.echo(as_text(provenance))
    if "page" in graph.model:
        from orbits.machines.page.loading import page_changed

        changed = page_changed(graph.model)
        if changed:
            typer.echo(f"{file}: {changed}", err=True)


class Format(StrEnum):
    """Formats that `export` can write."""

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
    from ..export import ENDINGS, check_target
    from ..export import export as write

    if to is None:
        ending = output.suffix.removeprefix(".") if output is not None else ""
        ending = next((form for form, extension in ENDINGS.items() if extension == ending), ending)
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
    from ..loci.chart import Chart
    from ..store import load

    graph = load(file, problems=measures, trust=trust)
    if isinstance(graph, Chart):
        from ..export.files import export_chart

        typer.echo(str(export_chart(graph, to.value, target)))
        return
    say_state(graph, file, measures)
    typer.echo(str(write(graph, to.value, target)))
    if to is Format.auto and any(
        branch.problem is None and "cycle" in branch.description for branch in graph.branches.values()
    ):
        say(f"the file of solutions has no cycles: {file} names Python code, which --trust would run")


def report(
    file: Annotated[
        Path,
        argument("FILE", "Result of diagram, atlas or chart (.vines), survey (.nc) or recommend (.json)."),
    ],
    output: Annotated[
        Path | None,
        option("-o, --output PAGE.html", "The page; by default FILE.html in this folder."),
    ] = None,
    pdf: Annotated[
        Path | None,
        option(
            "--pdf FILE.pdf",
            "Also a PDF, printed by the browser of this computer (a recommendation needs no browser).",
        ),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Write a result as one HTML page, which needs no network.

    The diagram or chart can be zoomed; a click on any point shows its orbit:
    portrait, history, an animation, word, multipliers, margins, and the command
    and the Python line that give it again. The page of a survey shows outcomes
    over the varied parameters and the machines of each point; that of a
    recommendation the answer, pictures, tables and assumptions on two sheets.
    """
    from ..report.page import check_page, write_report

    target, answer, result = output or beside(file, ".html"), None, None
    if pdf is not None and (pdf.suffix.lower() != ".pdf" or not pdf.parent.is_dir()):
        raise ValueError(f"--pdf {pdf}: give the name of a file that ends in .pdf, in a folder that exists.")
    check_page(target, plotly=file.suffix != ".json")
    if file.suffix == ".json":
        answer = _answer(file)
        target.write_text(answer.page(), encoding="utf-8")
    else:
        result = _result(file, trust)
        write_report(result, target, file.name, trust)
    typer.echo(str(target))
    if pdf is not None:
        typer.echo(f"{pdf} ({_on_paper(answer, target, pdf)})")
    branches = getattr(result, "branches", {}) or getattr(result, "loci", {})
    if branches and not trust and all(branch.problem is None for branch in branches.values()):
        say(f"the page has no orbits: {file} names Python code, which --trust would run")
    if not getattr(result, "finished", True):
        say(f"{file} is unfinished: the page shows what there is so far")


def _on_paper(answer: Answer | None, page: Path, pdf: Path) -> str:
    """Write the PDF of a page, by a browser or (for an answer) without one; return a description of how."""
    from ..report.answer import print_page, set_answer

    try:
        return f"printed by {print_page(page, pdf)}"
    except ValueError:
        if answer is None:
            raise
        set_answer(answer, pdf)
        return "set by matplotlib, as no browser could print the page"


def _result(file: Path, trust: bool) -> Graph | Chart | Survey:
    """Load the graph, chart or survey of a file."""
    if file.suffix == ".nc":
        from ..survey import load_survey

        survey = load_survey(file)
        if not survey.columns:
            raise ValueError(f"{file}: all machines of the survey failed; its CSV says why.")
        return survey
    from ..loci.chart import Chart
    from ..store import load

    result = load(file, trust=trust)
    if isinstance(result, Chart):
        if not result.loci:
            raise ValueError(f"{file} has no finished locus yet; run the command that made it again.")
    elif not result.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    return result


def _answer(file: Path) -> Answer:
    """Return the page of a recommendation's file."""
    from ..journal import provenance
    from ..report.answer import Answer
    from .recommend import kept, report_pictures
    from .recommendation import Recommendation

    found = Recommendation.from_dict(kept(file)["recommendation"])
    machine = [(name.replace("_", " "), text) for name, text in found.machine.items()]
    checked = []
    if found.checked is not None:
        diagram, simulated = (found.shown("peak", value) for value in found.checked)
        checked = [f"Checked by simulation: {simulated} beside {diagram} of the diagram."]
    lists = [("Assumed", found.assumed), ("Not known", found.first_unknown or ["nothing that was asked"])]
    return Answer(
        found.title,
        found.headline,
        [*found.sentences, *checked],
        report_pictures(found),
        [*found.tables, ("The machine", machine)],
        [(title, sentences) for title, sentences in lists if sentences],
        f"contvines {provenance()['contvines']}, from {found.study}",
    )


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
    from ..journal import as_text, provenance
    from ..loci.chart import Chart
    from ..store import Store, load
    from ..store.differences import differences, of_chart, of_graph
    from ..store.files import FROM_PYTHON
    from .study import kept_study

    before = load(file, problems=False)
    refuse_unfinished(before, file)
    with Store.open(file) as store:
        earlier, fingerprint, stored = store.made, store.fingerprint, store.study or {}
    if not stored.get("source") and fingerprint == FROM_PYTHON:
        raise ValueError(
            f"{file}: this file keeps no study to run again, as it was saved from Python (graph.save): the script that made it computes it anew. "
            "Files that contvines diagram, atlas and chart write keep theirs; a study may name a flow or a machine in a Python file."
        )
    study, source = kept_study(file, stored.get("source"), trust)
    target = place_of(output, file, "-rerun.vines")
    command = source["command"]
    if command == "atlas" and not isinstance(before, Chart) and "budget" in before.settings:
        study = study.having(
            "atlas", budget=before.settings["budget"]
        )  # the run may have continued with a larger budget
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
        tell(None, {"before": earlier, "after": provenance(), "same_study": same, "differences": found})
    else:
        if not same:
            say("what the study names has changed since: the two results are of different studies.")
        typer.echo("\n".join([_size(after), *(found or ["no differences"])]))
        if not quiet:
            typer.echo(f"before: {as_text(earlier) or 'made by a version that did not say so'}")
            typer.echo(f"after:  {as_text(provenance())}")
    if found or not same:
        raise typer.Exit(1)


def _finished(target: Path) -> bool:
    """Whether the file of an earlier run is finished; an unfinished run is resumed."""
    from ..store import Store

    if not target.is_file():
        return False
    with Store.open(target) as store:
        return store.finished


def _size(result: Graph | Chart) -> str:
    """Describe the size of a compared result."""
    from ..loci.chart import Chart

    if isinstance(result, Chart):
        return f"{len(result.loci)} loci and {len(result.points)} points of codimension two compared"
    counts = len(result.branches), len(result.special), len(result.switches)
    return "{} branches, {} special points and {} switches compared".format(*counts)
