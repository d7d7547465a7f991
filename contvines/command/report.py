"""`contvines report`: a result as one page to send round."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from contvines.command.frame import beside, say
from contvines.command.options import TrustOption, argument, option

if TYPE_CHECKING:
    from contvines.graph.graph import Graph
    from contvines.loci.chart import Chart
    from contvines.report.answer import Answer
    from contvines.survey.results import Survey


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
    from contvines.report.answer import print_page
    from contvines.report.page import check_page, write_report

    target = output or beside(file, ".html")
    if pdf is not None and (pdf.suffix.lower() != ".pdf" or not pdf.parent.is_dir()):
        raise ValueError(f"--pdf {pdf}: give the name of a file that ends in .pdf, in a folder that exists.")
    if file.suffix == ".json":
        check_page(target, plotly=False)
        answer = _answer(file)
        target.write_text(answer.page(), encoding="utf-8")
        typer.echo(str(target))
        if pdf is not None:
            typer.echo(f"{pdf} ({_on_paper(answer, target, pdf)})")
        return
    check_page(target)
    result = _result(file, trust)
    typer.echo(str(write_report(result, target, file.name, trust)))
    if pdf is not None:
        typer.echo(f"{pdf} (printed by {print_page(target, pdf)})")
    branches = getattr(result, "branches", {}) or getattr(result, "loci", {})
    if branches and not trust and all(branch.problem is None for branch in branches.values()):
        say(f"the page has no orbits: {file} names Python code, which --trust would run")
    if not getattr(result, "finished", True):
        say(f"{file} is unfinished: the page shows what there is so far")


def _on_paper(answer: "Answer", page: Path, pdf: Path) -> str:
    """Print the page, or set the answer without a browser; how it was done."""
    from contvines.report.answer import print_page
    from contvines.report.paper import set_answer

    try:
        return f"printed by {print_page(page, pdf)}"
    except ValueError:
        set_answer(answer, pdf)
        return "set by matplotlib, as no browser could print the page"


def _result(file: Path, trust: bool) -> "Graph | Chart | Survey":
    """The graph, chart or survey that a file holds."""
    if file.suffix == ".nc":
        from contvines.survey import load_survey

        survey = load_survey(file)
        if not survey.columns:
            raise ValueError(f"{file}: all machines of the survey failed; its CSV says why.")
        return survey
    from contvines.loci.chart import Chart
    from contvines.store import load

    result = load(file, trust=trust)
    if isinstance(result, Chart):
        if not result.loci:
            raise ValueError(f"{file} has no finished locus yet; run the command that made it again.")
    elif not result.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    return result


def _answer(file: Path) -> "Answer":
    """The page of a recommendation."""
    from contvines.command.recommend import kept
    from contvines.command.recommend_picture import report_pictures
    from contvines.command.recommendation import Recommendation
    from contvines.provenance import provenance
    from contvines.report.answer import Answer

    found = Recommendation.from_dict(kept(file)["recommendation"])
    machine = [(name.replace("_", " "), text) for name, text in found.machine.items()]
    checked = []
    if found.checked is not None:
        by, simulated = (found.shown("peak", value) for value in found.checked)
        checked = [f"Checked by simulation: {simulated} beside {by} of the diagram."]
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
