"""Long work: its progress on a terminal, in a notebook or a log, and Ctrl-C, by which nothing is lost or falsified and no write cut in two.

`diagram`, `atlas`, `chart` and `survey` go through :func:`carried_out`. It shows their progress, remembers in memory what is done
where no journal is given, and turns Ctrl-C into :class:`Interrupted`, whose ``graph`` holds all that is done; `resume` goes on.

Python raises KeyboardInterrupt wherever it happens to be. In a callback that compiled code calls it can only be ignored,
and what the callback was to compute is then wrong; in a write it leaves a transaction open. So there are sections: from
one that is held the interrupt is raised at the end; from another one at once, and again at the end if it was ignored inside.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ContextDecorator, contextmanager
from functools import partial
from threading import get_ident
from time import monotonic
from types import FrameType, TracebackType
from typing import Any, Literal, TypeVar

from .journal import Interrupted, Journal, MemoryJournal, Resumable, checked, unfinished

# what `signal` hands on to: it makes enumerations of handlers, which takes longer than solving a point
_plain = sys.modules["_signal"]

MAIN = threading.main_thread().ident
"""The thread in which interrupts are raised; sections of others hold nothing and take nothing."""


class _State:
    wanted = False  # an interrupt has come that nobody has taken
    held = 0  # held sections that are open
    alone = False  # the outermost of them listens itself
    listening = False  # somebody does already


_state = _State()


class _Listening(ContextDecorator):
    """See :func:`listening`."""

    own = False

    def _recreate_cm(self) -> _Listening:  # each call of a decorated function listens by itself
        return _Listening()

    def __enter__(self) -> None:
        if not _unheard():
            return
        _state.listening = True
        try:
            _plain.signal(signal.SIGINT, _interrupted)
        except BaseException:  # an interrupt that came before: nothing begins
            _state.listening = False
            raise
        self.own = True
        if _state.wanted:
            self.__exit__(None, None, None)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self.own:
            return
        if kind is not None:
            _state.wanted = False
        try:
            _plain.signal(signal.SIGINT, signal.default_int_handler)
        finally:
            _state.held, _state.listening = 0, False
            came, _state.wanted = _state.wanted, False
        if came:
            raise KeyboardInterrupt


def listening() -> _Listening:
    """Raise interrupts in good order inside, as a context or a decorator; a handler of the user's own is left alone."""
    return _Listening()


def _unheard() -> bool:
    """Whether an interrupt would be raised by Python itself, at once."""
    return get_ident() == MAIN and _plain.getsignal(signal.SIGINT) is signal.default_int_handler


def wanted() -> bool:
    """Whether an interrupt has come that is raised at the end of the section."""
    return _state.wanted and get_ident() == MAIN


def take() -> None:
    """The interrupt has been noticed: it is not raised once more."""
    _state.wanted = False


class Section:
    """Work at whose end an interrupt is raised that was kept back, or ignored, inside; its result is then not used.

    One that is held does so outside of `listening`, too.

    Parameters
    ----------
    held : bool
        Keep interrupts back.
    """

    __slots__ = ("held",)

    def __init__(self, held: bool) -> None:
        self.held = held

    def __enter__(self) -> None:
        if get_ident() != MAIN:
            return
        if self.held and not _state.held and not _state.listening and _unheard():
            _plain.signal(signal.SIGINT, _interrupted)
            _state.held, _state.alone = 1, True
        else:
            _state.held += self.held

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if get_ident() != MAIN:
            return
        if self.held and _state.held:
            _state.held -= 1
            if _state.alone and not _state.held:
                _state.alone = False
                _plain.signal(signal.SIGINT, signal.default_int_handler)
                if kind is not None:
                    _state.wanted = False
        if _state.wanted and kind is None and not _state.held:
            _state.wanted = False
            raise KeyboardInterrupt


HELD, OPEN = Section(True), Section(False)


# where sections begin and end nothing is cut in two either: what comes there is raised when it is done
ENDS = {f.__code__ for c in (Section, _Listening) for f in (c.__enter__, c.__exit__)}


def _interrupted(number: int, frame: FrameType | None) -> None:
    _state.wanted = True
    if not _state.held and (frame is None or frame.f_code not in ENDS):
        raise KeyboardInterrupt


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


def as_text(state: object) -> str:
    """Where a run, a chart or a survey is, in one line: its ``sentence``, where it has one."""
    return getattr(state, "sentence", "") or str(state)


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
