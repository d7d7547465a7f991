"""Progress of long work: a line on a terminal or in a notebook, now and then a line in a log."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any, Protocol, runtime_checkable

Tell = Callable[[Any], None]
FIRST, AGAIN = 20.0, 60.0  # seconds until a log gets its first line, and between two of them


@contextmanager
def shown(asked: Tell | bool | None = None) -> Iterator[Tell | None]:
    """What long work tells its progress to; None where nobody listens.

    Parameters
    ----------
    asked : callable, bool or None
        A callable is called with everything. None: a line on a terminal or in a notebook, else silence; also if the environment variable
        ``CONTVINES_PROGRESS`` is ``off``. True: the same, and a line a minute in a log or a pipe. False: silence.
    """
    if callable(asked):
        yield asked
    elif asked is False or os.environ.get("CONTVINES_PROGRESS") == "off":
        yield None
    elif _in_notebook():
        with _notebook() as tell:
            yield tell
    elif sys.stderr.isatty():
        with _terminal() as tell:
            yield tell
    else:
        yield _Log() if asked else None


class TimeLeft(Protocol):
    """How much of a piece of work is known to be left."""

    @property
    def done(self) -> int: ...
    @property
    def known(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def budget(self) -> float: ...


@runtime_checkable
class Spoken(Protocol):
    """A state that says itself where it is."""

    @property
    def sentence(self) -> str: ...


@runtime_checkable
class Running(Protocol):
    """The state of a diagram that is being made."""

    @property
    def message(self) -> str: ...
    @property
    def branches(self) -> int: ...
    @property
    def special(self) -> int: ...
    @property
    def points(self) -> int: ...
    @property
    def waiting(self) -> int: ...
    @property
    def left(self) -> TimeLeft | None: ...


def as_text(state: object) -> str:
    """Where a run, a chart or a survey is, in one line."""
    if isinstance(state, Spoken) and state.sentence:
        return state.sentence
    if not isinstance(state, Running):
        return str(state)
    left = state.left
    return (
        f"{state.message}  |  {state.branches} branch{'' if state.branches == 1 else 'es'}, {state.special} special points, "
        f"{state.points} points, {state.waiting} waiting"
        + ("" if left is None else f"; {left.done} of {left.known} pieces of work known so far")
        + ("" if left is None else f"{time_left(left.seconds)}, {left.budget:.0%} of the budget")
    )


def time_left(seconds: float) -> str:
    """An estimate of a time as people say it, after a comma; nothing if there is none."""
    if not seconds > 0.0:
        return ""
    return f", about {f'{seconds:.0f} s' if seconds < 100.0 else f'{seconds / 60.0:.0f} min'} left"


@contextmanager
def _terminal() -> Iterator[Tell]:
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("starting")
        yield lambda state: progress.update(task, description=as_text(state))


def _in_notebook() -> bool:
    """Whether this is a notebook's kernel; nothing is imported to find out."""
    module = sys.modules.get("IPython")
    shell = module.get_ipython() if module is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"


@contextmanager
def _notebook(say: Callable[[Any], str] = as_text) -> Iterator[Tell]:
    from IPython.display import display

    line = display({"text/plain": "starting"}, raw=True, display_id=True)
    assert line is not None
    try:
        yield lambda state: line.update({"text/plain": say(state)}, raw=True)
    finally:
        line.update({"text/plain": ""}, raw=True)


class _Log:
    """A line on stderr from time to time."""

    def __init__(self, say: Callable[[Any], str] = as_text) -> None:
        self.due, self.say = monotonic() + FIRST, say

    def __call__(self, state: object) -> None:
        if monotonic() >= self.due:
            self.due = monotonic() + AGAIN
            print(f"contvines: {self.say(state)}", file=sys.stderr, flush=True)


@contextmanager
def counted(total: int, what: str, asked: Tell | bool | None = None, done: int = 0) -> Iterator[Tell | None]:
    """Progress of so many pieces of work, told after each; `asked` as for :func:`shown`, `done` that an earlier run has done.

    No thread draws by itself here: beside one, worker processes could not be copies of this process.
    """
    if callable(asked) or asked is False or os.environ.get("CONTVINES_PROGRESS") == "off":
        yield asked if callable(asked) else None
        return

    def count(_: object) -> str:
        return f"{done} of {total} {what}"

    def telling(tell: Tell) -> Tell:
        def tick(piece: object) -> None:
            nonlocal done
            done += 1
            tell(piece)

        return tick

    if _in_notebook():
        with _notebook(count) as tell:
            yield telling(tell)
    elif sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import Progress

        with Progress(console=Console(stderr=True), transient=True, auto_refresh=False) as progress:
            task = progress.add_task(what, total=total, completed=done)
            yield lambda _: progress.update(task, advance=1, refresh=True)
    else:
        yield telling(_Log(count)) if asked else None
