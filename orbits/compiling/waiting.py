"""Waiting for what another process compiles meanwhile (`orbits.precompile` starts it)."""

from __future__ import annotations

import subprocess
import time
from typing import Any

processes: dict[str, subprocess.Popen[bytes]] = {}
"""Processes that compile for the machine of that name, or the function of that name for many machines."""

PATIENCE = 60.0  # seconds to wait for one function


def wait_for(name: str, function: Any) -> None:
    """Wait while the process called `name` is at work and numba's cache lacks `function`.

    If that takes too long the function is compiled here as well.
    """
    process = processes.get(name)
    deadline = time.monotonic() + PATIENCE
    while process is not None and not function.overloads and not cached(function):
        if process.poll() is not None or time.monotonic() > deadline:
            processes.pop(name, None)
            return
        time.sleep(0.005)


def cached(function: Any) -> bool:
    """Whether numba's cache on disk holds a compiled `function`; True where that cannot be told."""
    try:
        return bool(function._cache._cache_file._load_index())
    except (AttributeError, OSError):
        return True
