"""`contvines report`: a result as one page to send round."""

from pathlib import Path
from typing import Annotated, Any

import typer

from contvines.command.frame import beside, load_file, say
from contvines.command.options import TrustOption


def report(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="What diagram, atlas or chart (.vines) or survey (.nc) has made."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PAGE.html", help="The page; by default FILE.html here."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Write a result as one HTML page that needs no network.

    The diagram or chart can be zoomed; a click on any point shows its orbit:
    portrait, history, an animation, word, multipliers, margins, and the command
    and the Python line that give it again. Of a survey: outcomes over what
    varies, and the machines behind each point.
    """
    from contvines.report.page import check_page, write_report

    target = output or beside(file, ".html")
    check_page(target)
    result = _result(file, trust)
    typer.echo(str(write_report(result, target, file.name, trust)))
    branches = getattr(result, "branches", {}) or getattr(result, "loci", {})
    if branches and not trust and all(branch.problem is None for branch in branches.values()):
        say(f"the page has no orbits: {file} names Python code, which --trust would run")
    if not getattr(result, "finished", True):
        say(f"{file} is unfinished: the page shows what there is so far")


def _result(file: Path, trust: bool) -> Any:
    """The graph, chart or survey that a file holds."""
    if file.suffix == ".nc":
        from contvines.survey import load_survey

        survey = load_survey(file)
        if not survey.columns:
            raise ValueError(f"{file}: all machines of the survey failed; its CSV says why.")
        return survey
    from contvines.loci.chart import Chart

    result = load_file(file, trust, charts=True)
    if isinstance(result, Chart):
        if not result.loci:
            raise ValueError(f"{file} has no finished locus yet; run the command that made it again.")
    elif not result.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    return result
