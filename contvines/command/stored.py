"""Results in files: what is said of them when they are loaded, and those that need not be computed again."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import typer


def say_what_lacks(graph: Any) -> None:
    """Branches that were loaded as numbers only, and why, on stderr; they are drawn and written without measures."""
    from contvines.problems.registry import without_problem

    for branch in graph.branches.values():
        if branch.problem is None and branch.description.get("factory"):
            typer.echo(f"contvines: {without_problem(branch.label, branch.description)}.", err=True)
            return


def refuse_detached(graph: Any, labels: Iterable[str]) -> None:
    """Special points whose problem is not at hand, before work starts: a sentence that says why, and what would do."""
    from contvines.problems.registry import without_problem

    for label in labels:
        point = graph.special[label]
        if point.problem is None:
            branch = graph.branches.get(point.branch)
            raise ValueError(without_problem(label, None if branch is None else branch.description))


def say_unfinished(file: Path) -> None:
    typer.echo(
        f"{file} is unfinished: its run goes on, or was stopped; the same command continues it.", err=True
    )


def finished_of(target: Path, fingerprint: str, quiet: bool, *, problems: bool) -> Any:
    """The finished result of a run in its file; None if the run is still to be done, or to be gone on with.

    Raises
    ------
    ValueError
        If the file is refused, or belongs to another run.
    """
    from contvines.command.compose import say
    from contvines.store import Store

    if not target.exists():
        return None
    with Store.open(target) as store:
        store.require(fingerprint)
        if store.finished:
            return store.graph(problems=problems)
        say(f"{target} is unfinished: going on after {store.records} finished pieces of work.", quiet)
        return None
