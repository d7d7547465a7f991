"""Ctrl-C while compiled code runs that may call Python back.

Python can only ignore an exception in such a callback, and what the callback was to compute is then wrong. So the interrupt waits
until the compiled code is done.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def kept_back() -> Iterator[None]:
    """Keep an interrupt until the end; whoever listens to interrupts (Python itself, or a handler in its place) gets it then."""
    listener = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(listener):
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    signal.signal(signal.SIGINT, lambda number, frame: came.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, listener)
    if came:
        listener(*came[0])
