"""Long work from Python: progress while it goes on, and nothing lost when it is interrupted.

`diagram`, `atlas`, `chart` and `survey` go through :func:`carried_out`. It shows their progress, remembers in memory what is done
where no journal is given, and turns Ctrl-C into :class:`Interrupted`, whose ``graph`` holds all that is done; `resume` goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Literal, TypeVar

from .interrupts import Interrupted, Resumable, take, unfinished
from .journal import Journal, MemoryJournal, checked
from .progress import Tell, shown

OnInterrupt = Literal["raise", "return"]
Asked = Tell | bool | None
"""``progress`` of the long functions: a callable, False for none, None for a line on a terminal or in a notebook."""


Result = TypeVar("Result", bound=Resumable)


def carried_out(
    begin: Callable[[Journal, Tell | None], tuple[Result, Callable[[], None]]],
    journal: Journal | None,
    progress: Asked,
    interrupt: OnInterrupt,
) -> Result:
    """The result of long work.

    Parameters
    ----------
    begin : callable
        From a journal and what is told of progress: the result, still empty, and the work that fills it in place.
    journal : Journal or None
        None: what is done is remembered in memory until the work is finished.
    progress : callable, bool or None
    interrupt : "raise" or "return"
        What Ctrl-C does: raise `Interrupted`, or end with the unfinished result.

    Raises
    ------
    Interrupted
        On Ctrl-C once the work has begun.
    ValueError
        If `interrupt` is neither word, or the journal is none.
    """
    check_interrupt(interrupt)
    kept = MemoryJournal() if journal is None else checked(journal)
    with shown(progress) as tell:
        result, work = begin(kept, tell)
        try:
            work()
        except KeyboardInterrupt:
            take()
            unfinished(result, partial(carried_out, begin, kept, progress, interrupt))
            if interrupt == "return":
                return result
            raise Interrupted(result) from None
    return result


def check_interrupt(interrupt: str) -> None:
    """Refuse what Ctrl-C cannot do."""
    if interrupt not in ("raise", "return"):
        raise ValueError(
            f'interrupt = {interrupt!r} must be "raise" (Ctrl-C raises contvines.Interrupted) or "return" (it ends with what is done)'
        )
