"""Progress on a terminal; nothing in a pipe."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def shown(*, quiet: bool) -> Iterator[Callable[[Any], None] | None]:
    """What to hand to `contvines.diagram(progress=...)`: a line on stderr if that is a terminal, else None."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("starting (the first run compiles its kernels)")

        def tell(state: Any) -> None:
            own = getattr(state, "sentence", None)
            text = own or (
                f"{state.message}  |  {state.branches} branch{'' if state.branches == 1 else 'es'}, {state.special} special points, "
                f"{state.points} points, {state.waiting} waiting"
                + (f", {state.done:.0%} of the budget" if state.done == state.done else "")
            )
            progress.update(task, description=text)

        yield tell
