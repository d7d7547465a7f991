"""What is said of a stored graph when it is loaded."""

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


def say_unfinished(file: Path) -> None:
    typer.echo(
        f"{file} is unfinished: its run goes on, or was stopped; the same command continues it.", err=True
    )
