"""`contvines show`: a stored graph as a table or as JSON."""

import typer

from contvines.command.options import FileArgument, JsonOption
from contvines.command.stored import say_unfinished


def show(file: FileArgument, json: JsonOption = False) -> None:
    """List branches, special points and switches."""
    from contvines.store import load

    graph = load(file, problems=False)
    if json:
        from contvines.export import json_text

        typer.echo(json_text(graph.to_dict()))
        return
    if not graph.finished:
        say_unfinished(file)
    typer.echo(str(graph))
    if "page" in graph.model:
        from orbits.declared.stored import page_changed

        changed = page_changed(graph.model)
        if changed:
            typer.echo(f"{file}: {changed}", err=True)
