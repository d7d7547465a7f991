"""Ctrl-C while work goes on: it is not lost, falsifies nothing and cuts no write in two.

Python raises KeyboardInterrupt wherever it happens to be. In a callback that compiled code calls it can only be ignored,
and what the callback was to compute is then wrong; in a write it leaves a transaction open. So there are sections: from
one that is held the interrupt is raised at the end; from another one at once, and again at the end if it was ignored inside.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import ContextDecorator
from threading import get_ident
from types import FrameType, MappingProxyType, TracebackType
from typing import Any

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


class Resumable:
    """A result that interrupted work may leave.

    Attributes
    ----------
    rest : callable or None
        Goes on with the interrupted work, from what is done, and returns the whole result; None where nothing was interrupted,
        and in results from files.
    origin : mapping
        Of a result from a file: the ``study`` that the file keeps, seeds included, and with what it was ``made``.
    """

    rest: Callable[[], Any] | None = None
    origin: Mapping[str, Any] = MappingProxyType({})

    @property
    def stopped(self) -> bool:
        """Whether a budget is used up: with a larger one the same call goes on."""
        return False


class Interrupted(KeyboardInterrupt):
    """Raised when Ctrl-C stops a long computation.

    Attributes
    ----------
    graph : Graph, Chart or Survey
        All that is done; ``contvines.resume(graph)`` goes on.
    """

    def __init__(self, graph: Resumable) -> None:
        super().__init__(
            f"interrupted: all that is done is in .graph, {graph!r}; contvines.resume(that graph) goes on"
        )
        self.graph = graph


def unfinished(result: Resumable, rest: Callable[[], Any]) -> None:
    """Say how interrupted work goes on; a result may be frozen."""
    object.__setattr__(result, "rest", rest)
