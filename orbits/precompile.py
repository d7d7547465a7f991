"""Compiling beside other work: what a first run needs later is compiled by a second process meanwhile.

numba compiles one function at a time in a process. On a machine with a second core another process compiles the
kernel `inspect` and the elimination of long words, while this one compiles Newton's
method, the continuation loop and what judges borders; both find each other's results in numba's cache on disk. The work is parted so
that both end at about the same time.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys

import numpy as np
from numba import config, typeof

from orbits.compiling.waiting import cached, processes
from orbits.cycles import kernels
from orbits.elimination import by_address
from orbits.machines.catalogue import usual
from orbits.multipliers.factors import scratch_size
from orbits.multipliers.periodic_qr import periodic_multipliers
from orbits.multipliers.periodic_schur import multipliers_of, multipliers_of_two


def compile_ahead(name: str, *more: str) -> subprocess.Popen[bytes] | None:
    """Start compiling for the model called `name` in a process of its own, if anything is missing from the cache.

    Parameters
    ----------
    name : str
    *more : str
        "module:function" of what else to call there.

    Returns
    -------
    subprocess.Popen or None
        The process; this one waits for it where it would otherwise compile the same functions itself. None if there is nothing
        to compile or no second core.
    """
    running = processes.get(name)
    if running is not None and running.poll() is None:
        return running
    if _cores() < 2 or not _missing(name):
        return None
    digest = kernels.assemble(usual(name)[0]).digest
    program = "import gc; gc.set_threshold(200_000, 20, 100)\n"  # compiling makes many objects that stay
    program += "from contvines_ground.stack import with_room; from orbits.precompile import compile_as\n"
    program += f"with_room(compile_as, {digest!r}, {name!r}, *{more!r})\n"
    program += "gc.freeze()"  # else everything is looked through once more at the end
    # the very modules and the very cache of this process, wherever it was started
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    place = getattr(config, "CACHE_DIR", "")
    if place:
        environment["NUMBA_CACHE_DIR"] = str(place)
    quiet = subprocess.DEVNULL
    try:
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", program],
            stdin=quiet,
            stdout=quiet,
            stderr=quiet,
            env=environment,
            start_new_session=True,
        )
    except OSError:
        return None
    processes[name] = process
    node = usual(name)[0].node
    if _is_slow(node):
        processes[periodic_multipliers.__name__] = process
    if node == 2:
        processes[by_address.__name__] = process
    return process


def _is_slow(node: int) -> bool:
    """Whether multipliers of nodes of this size need the periodic Schur form, which takes seconds to compile."""
    return multipliers_of(node) is not multipliers_of_two


def compile_as(digest: str, name: str, *more: str) -> None:
    """`compile_now`, if the sources are those with this digest: others would be compiled for nobody."""
    if kernels.assemble(usual(name)[0]).digest == digest:
        compile_now(name, *more)


def compile_now(name: str, *more: str) -> None:
    """Compile for the model called `name`, in the order in which a run asks for it."""
    from orbits.problem import OrbitProblem
    from orbits.words import Word

    model, _ = usual(name)
    problem = OrbitProblem(
        model, Word.parse("LR"), 1, model.parameter_names[0], np.zeros(len(model.parameter_names))
    )
    unknowns, row = np.zeros(problem.dimension), np.zeros(1)
    data, work, compiled = problem.data, problem.workspace(), problem.kernels
    arguments = tuple(map(typeof, (data, unknowns, 0.0, work, row)))
    compiled.inspect.compile(arguments)
    for place in more:
        module, _, function = place.partition(":")
        getattr(importlib.import_module(module), function)()
    n = model.node
    if _is_slow(n):
        factors = np.tile(np.diag(np.arange(1.0, n + 1.0)), (2, 1, 1))
        periodic_multipliers(factors, -factors, 1.0, np.zeros(n), np.zeros(n), np.zeros(scratch_size(2, n)))
    if n == 2:
        by_address.function()
    compiled.flip.compile(tuple(map(typeof, (data, work, 0.0))))


def _cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _missing(name: str) -> bool:
    """Whether numba's cache lacks the kernel `inspect`; False where that cannot be told."""
    return not cached(kernels.assemble(usual(name)[0]).inspect)
