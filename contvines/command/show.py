"""`contvines show`: a stored graph as a table or as JSON."""

import typer

from contvines.command.frame import say_state, tell
from contvines.command.options import FileArgument, JsonOption


def show(file: FileArgument, json: JsonOption = False) -> None:
    """List branches, special points and switches."""
    from contvines.provenance import as_text
    from contvines.store import Store, load

    graph = load(file, problems=False)
    with Store.open(file) as store:
        made = store.made
    if json:
        tell(graph, {**graph.to_dict(), "made": made})
        return
    say_state(graph, file, problems=False)
    typer.echo(str(graph))
    if made:
        typer.echo(as_text(made))
    if "page" in graph.model:
        from orbits.machines.page.loading import page_changed

        changed = page_changed(graph.model)
        if changed:
            typer.echo(f"{file}: {changed}", err=True)
