"""Progress on a terminal: what a journal is told is also what there is to show."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class Watched:
    """A journal that passes everything on and tells a display of it."""

    def __init__(self, journal: Any, tell: Any):
        self._journal = journal
        self._tell = tell
        self.records = 0

    def recall(self, key: str) -> dict[str, Any] | None:
        """See `contvines.journal.Journal`."""
        return self._journal.recall(key)

    def record(self, key: str, values: dict[str, Any]) -> None:
        """See `contvines.journal.Journal`."""
        self._journal.record(key, values)
        self.records += 1
        self._tell(records=self.records)

    def checkpoint(self, graph: Any) -> None:
        """See `contvines.journal.Journal`."""
        self._journal.checkpoint(graph)
        self._tell(graph=graph)


@contextmanager
def watched(journal: Any, *, quiet: bool) -> Iterator[Any]:
    """The journal, with a line of progress on stderr if that is a terminal and the user wants it."""
    if quiet or not sys.stderr.isatty():
        yield journal
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("starting")
        state = {"records": 0, "found": "following the first branch"}

        def tell(records: int | None = None, graph: Any = None) -> None:
            if records is not None:
                state["records"] = records
            if graph is not None:
                points = sum(len(b) for b in graph.branches.values())
                state["found"] = (
                    f"{len(graph.branches)} branches, {points} points, {len(graph.special)} special points"
                )
            progress.update(task, description=f"{state['found']}; {state['records']} pieces of work kept")

        yield Watched(journal, tell)
