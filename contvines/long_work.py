"""Progress of long computations on a terminal, in a notebook or a log, and their interruption by Ctrl-C.

`diagram`, `atlas` and `chart` run inside :func:`carried_out`. It shows progress, keeps a journal in memory if none is given, and turns
Ctrl-C into :class:`Interrupted`, whose ``graph`` is the partial result; `resume` continues.

Python raises KeyboardInterrupt at an arbitrary instruction. In a callback from compiled code the exception is lost and the callback's
result is wrong; in a write it leaves a transaction open. Critical code therefore runs in a :class:`Section`:

- ``HELD`` delays the interrupt to the end of the section;
- ``OPEN`` lets it through at once, and raises it again at the end if compiled code has ignored it.
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

# the C module behind `signal`: the functions of `signal` convert handlers to enumerations, which takes longer than solving a point
_plain = sys.modules["_signal"]

MAIN = threading.main_thread().ident
"""Identifier of the main thread, the only one in which Python raises interrupts; sections do nothing in other threads."""


class _State:
    wanted = False  # an interrupt has arrived and has not been dealt with
    held = 0  # number of open held sections
    alone = False  # the outermost held section has installed the signal handler itself
    listening = False  # a `listening` context has installed the handler


_state = _State()


class _Listening(ContextDecorator):
    """Context manager and decorator returned by :func:`listening`."""

    own = False  # whether this instance has installed the handler, and must remove it

    def _recreate_cm(self) -> _Listening:  # a fresh instance for each call of a decorated function
        return _Listening()

    def __enter__(self) -> None:
        if not _default_handler_active():
            return
        _state.listening = True
        try:
            _plain.signal(signal.SIGINT, _interrupted)
        except BaseException:  # an interrupt arrived before the handler was installed
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
            interrupted, _state.wanted = _state.wanted, False
        if interrupted:
            raise KeyboardInterrupt


def listening() -> _Listening:
    """Install the signal handler that respects sections, as a context manager or a decorator.

    It does nothing in other threads than the main one, or if the user has a SIGINT handler.
    """
    return _Listening()


def _default_handler_active() -> bool:
    """Whether Python's default SIGINT handler is active and this is the main thread."""
    return get_ident() == MAIN and _plain.getsignal(signal.SIGINT) is signal.default_int_handler


def wanted() -> bool:
    """Whether an interrupt is pending: the end of the section will raise it."""
    return _state.wanted and get_ident() == MAIN


def take() -> None:
    """Clear a pending interrupt, so that it is not raised again."""
    _state.wanted = False


class Section:
    """Context manager that raises a delayed or ignored interrupt at its end, so that the result of the code inside is not used.

    A held section works outside of `listening`, too.

    Parameters
    ----------
    held : bool
        Delay interrupts to the end of the section.
    """

    __slots__ = ("held",)

    def __init__(self, held: bool) -> None:
        self.held = held

    def __enter__(self) -> None:
        if get_ident() != MAIN:
            return
        if self.held and not _state.held and not _state.listening and _default_handler_active():
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


# code objects of the beginnings and ends of sections: an interrupt that arrives in them is delayed, too
ENDS = {f.__code__ for c in (Section, _Listening) for f in (c.__enter__, c.__exit__)}


def _interrupted(number: int, frame: FrameType | None) -> None:
    _state.wanted = True
    if not _state.held and (frame is None or frame.f_code not in ENDS):
        raise KeyboardInterrupt


Tell = Callable[[Any], None]
# seconds before the first line of progress in a log, and between further lines
FIRST_WAIT, INTERVAL = 20.0, 60.0


@contextmanager
def shown(asked: Tell | bool | None = None) -> Iterator[Tell | None]:
    """Yield the callable that displays the progress of a long computation; None for no display.

    Parameters
    ----------
    asked : callable, bool or None
        - a callable: it is called with each state of progress;
        - None: a line on a terminal or in a notebook, otherwise nothing;
        - True: likewise, and a line per minute in a log or a pipe;
        - False: nothing.

        The environment variable ``CONTVINES_PROGRESS=off`` turns the display off, except that of a callable.
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
    """Describe a state of progress in one line: its ``sentence`` if it has one, otherwise ``str``."""
    return getattr(state, "sentence", "") or str(state)


def time_left(seconds: float) -> str:
    """Return a text such as ``, about 5 min left``; empty if the time is not positive (or nan)."""
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
    """Whether this process is a notebook's kernel; IPython is not imported for the test."""
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
    """Progress in a log: a line on stderr after `FIRST_WAIT` seconds, then every `INTERVAL` seconds."""

    def __init__(self, say: Callable[[Any], str] = as_text) -> None:
        self.due, self.say = monotonic() + FIRST_WAIT, say

    def __call__(self, state: object) -> None:
        if monotonic() >= self.due:
            self.due = monotonic() + INTERVAL
            print(f"contvines: {self.say(state)}", file=sys.stderr, flush=True)


@contextmanager
def counted(total: int, noun: str, asked: Tell | bool | None = None, done: int = 0) -> Iterator[Tell | None]:
    """Yield a callable to be called after each piece of work, which displays the count; None for no display.

    No display thread is started: a process with threads cannot be forked into worker processes.

    Parameters
    ----------
    total : int
        Number of pieces.
    noun : str
        Name of the pieces, in the plural.
    asked : callable, bool or None
        As for :func:`shown`.
    done : int
        Pieces that an earlier run has finished.
    """
    if callable(asked) or asked is False or os.environ.get("CONTVINES_PROGRESS") == "off":
        yield asked if callable(asked) else None
        return

    def count(_: object) -> str:
        return f"{done} of {total} {noun}"

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
            task = progress.add_task(noun, total=total, completed=done)
            yield lambda _: progress.update(task, advance=1, refresh=True)
    else:
        yield telling(_Log(count)) if asked else None


OnInterrupt = Literal["raise", "return"]
Asked = Tell | bool | None
"""Type of the argument ``progress`` of long computations, see :func:`shown`."""


Result = TypeVar("Result", bound=Resumable)


def carried_out(
    begin: Callable[[Journal, Tell | None], tuple[Result, Callable[[], None]]],
    journal: Journal | None,
    progress: Asked,
    interrupt: OnInterrupt,
) -> Result:
    """Run a long computation that can be interrupted and resumed, and return its result.

    Parameters
    ----------
    begin : callable
        ``begin(journal, tell)`` returns the result, still empty, and a function without arguments that fills it in place.
    journal : Journal or None
        None: a `MemoryJournal`.
    progress : callable, bool or None
        As for :func:`shown`.
    interrupt : "raise" or "return"
        Effect of Ctrl-C: raise `Interrupted`, or return the partial result.

    Raises
    ------
    Interrupted
        On Ctrl-C once the computation has begun.
    ValueError
        If `interrupt` is neither of the two words, or `journal` lacks a method of a journal.
    """
    check_interrupt(interrupt)
    stored = MemoryJournal() if journal is None else checked(journal)
    with shown(progress) as tell:
        result, work = begin(stored, tell)
        try:
            work()
        except KeyboardInterrupt:
            take()
            unfinished(result, partial(carried_out, begin, stored, progress, interrupt))
            if interrupt == "return":
                return result
            raise Interrupted(result) from None
    return result


def check_interrupt(interrupt: str) -> None:
    """Check an argument ``interrupt``.

    Raises
    ------
    ValueError
        If it is neither "raise" nor "return".
    """
    if interrupt not in ("raise", "return"):
        raise ValueError(
            f'interrupt = {interrupt!r} must be "raise" (Ctrl-C raises contvines.Interrupted) or "return" (it ends with what is done)'
        )
