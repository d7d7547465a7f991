"""Waiting for what another process compiles meanwhile (`orbits.precompile` starts it)."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from typing import Any

from numba.core.caching import FunctionCache

processes: dict[str, subprocess.Popen[bytes]] = {}
"""Processes that compile for the machine of that name, or the function of that name for many machines."""

PATIENCE = 60.0  # seconds to wait for one function


def wait_for(name: str, function: Any) -> None:
    """Wait while the process called `name` is at work and numba's cache lacks `function`.

    If that takes too long the function is compiled here as well.
    """
    process = processes.get(name)
    if process is None or function.overloads:
        return
    deadline = time.monotonic() + PATIENCE
    while not cached(function):
        if process.poll() is not None or time.monotonic() > deadline:
            processes.pop(name, None)
            return
        time.sleep(0.005)


class Kept:
    """What `wait_for` asks of a function that numba compiles as soon as it is decorated, before it is."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.overloads: dict[Any, Any] = {}
        self._cache = FunctionCache(function)


def cached(function: Any) -> bool:
    """Whether numba's cache on disk holds a compiled `function`; True where that cannot be told."""
    try:
        return bool(function._cache._cache_file._load_index())
    except (AttributeError, OSError):
        return True
