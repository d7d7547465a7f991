"""Compiling the simulator while something else is being compiled.

The first run on a machine compiles continuation and simulation, one after the other, since numba compiles one function at
a time in a process. On a machine with a second core another process can compile the simulator meanwhile; both
find each other's results in numba's cache on disk.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from typing import Any


def compile_ahead(name: str) -> subprocess.Popen[bytes] | None:
    """Start compiling the stepper of the model called `name` in a process of its own, if none is cached.

    Returns
    -------
    subprocess.Popen or None
        The process, which nobody has to wait for; None if there is nothing to compile or no second core.
    """
    if (os.cpu_count() or 1) < 2 or not _missing(name):
        return None
    program = f"from orbits.simulation.ahead import compile_now; compile_now({name!r})"
    quiet = subprocess.DEVNULL
    try:
        return subprocess.Popen(
            [sys.executable, "-c", program], stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True
        )
    except OSError:
        return None


def compile_now(name: str) -> None:
    """Compile the stepper of the model called `name` by a short run."""
    from orbits.models import build
    from orbits.simulation.driver import simulate

    values: dict[str, Any] = {
        "name": name,
        "restitution": 0.5,
        "friction": 0.1,
        "gravity": 0.1,
        "mass_ratio": 0.01,
    }
    if name == "coupled":
        simulate(build(values | {"forcing": 1.0, "frequency": 0.9}), periods=0.5).sample()
    else:
        simulate(build(values), periods=0.5, amplitude=0.1).sample()


def _missing(name: str) -> bool:
    """Whether numba's cache has no compiled stepper that fits the sources; False where that cannot be told."""
    module = importlib.import_module(f"orbits.simulation.{name}_kernels")
    try:
        return not module.advance._cache._cache_file._load_index()
    except (AttributeError, OSError):
        return False
