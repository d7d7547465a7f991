"""`contvines report`: a result as one page to send round."""

from pathlib import Path
from typing import Annotated

import typer

from contvines.command.options import FileArgument, TrustOption


def report(
    file: FileArgument,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PAGE.html", help="The page; by default FILE.html here."),
    ] = None,
    trust: TrustOption = False,
) -> None:
    """Write a result as one HTML page that needs no network.

    The diagram can be zoomed; a click on any point shows its orbit: portrait,
    history, an animation, word, multipliers, margins, and the command and the
    Python line that give it again.
    """
    from contvines.command.compose import beside, say
    from contvines.report.page import check_page, write_report
    from contvines.store import load

    target = output or beside(file, ".html")
    check_page(target)
    graph = load(file, trust=trust)
    if not graph.branches:
        raise ValueError(f"{file} has no finished branch yet; run the command that made it again.")
    typer.echo(str(write_report(graph, target, file.name)))
    if not graph.finished:
        say(f"{file} is unfinished: the page shows what there is so far")
