"""Room on Python's stack for work that goes deep.

CPython keeps the frames of Python functions in chunks of 16 KB. A loop that stands at the end of one and calls a function has a
chunk mapped and given back with each turn, by two calls of the operating system: numba's compiler did so half a million times in
a first run, for a fifth to a third of its time. A function whose frame needs more gets a chunk of the next power of two, and what it calls
finds its frames in the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

DEEP = 70_000  # words of a frame: just above half of a chunk of 1 MB, so that nearly half of it is left


def with_room(work: Callable[..., Any], *arguments: Any) -> Any:
    """`work(*arguments)`, whose frames lie in one piece of memory (about half a megabyte of addresses, used as needed)."""
    return work(*arguments)


with_room.__code__ = with_room.__code__.replace(co_stacksize=DEEP)
