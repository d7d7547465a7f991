"""Ctrl-C while compiled code runs that may call Python back.

Python can only ignore an exception in such a callback, and what the callback was to compute is then wrong. So the interrupt waits
until the compiled code is done.
"""

from __future__ import annotations

import sys
from signal import SIGINT
from types import FrameType, TracebackType
from typing import Any

# what `signal` hands on to: it makes enumerations of handlers, which takes longer than a short word's mathematics
_plain: Any = sys.modules["_signal"]


class kept_back:
    """Keep an interrupt until the end; whoever listens to interrupts (Python itself, or a handler in its place) gets it then."""

    __slots__ = ("came", "listener")

    def __init__(self) -> None:
        self.listener: Any = None
        self.came: tuple[int, FrameType | None] | None = None

    def __enter__(self) -> None:
        listener = _plain.getsignal(SIGINT)
        if callable(listener):
            try:
                _plain.signal(SIGINT, self._comes)
            except ValueError:
                return  # the main thread alone is interrupted
            self.listener = listener

    def _comes(self, number: int, frame: FrameType | None) -> None:
        self.came = self.came or (number, frame)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.listener is None:
            return
        _plain.signal(SIGINT, self.listener)
        if self.came is not None and kind is None:
            self.listener(*self.came)
