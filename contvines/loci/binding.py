"""The kernels of a locus, made from those of the problem whose special points it collects.

The locus calls the problem's kernels at many places. Compiled, each of them is one function by itself that is called by
address: else the compiler would work through all of them again in every function that uses them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..continuation.binding import OPTIONS, copy_with
from ..problems.protocol import Kernels, kernels_digest
from . import kernels as source

HELPERS = ("null_test", "flipped_test", "pair_of", "tests", "slopes_along", "close", "renew")
NAMES = ("linearise", "bordered", "inspect", "assign", "flip", "transpose")
_interpreted: dict[tuple[Any, ...], Kernels] = {}
_compiled: dict[tuple[Any, ...], tuple[Kernels, np.ndarray]] = {}


def locus_kernels(problem: Any) -> tuple[Kernels, np.ndarray]:
    """Kernels of the loci of a problem, and the addresses of the problem's own; made once per process."""
    kernels = problem.kernels
    given = {name: getattr(kernels, name) for name in NAMES}
    key = tuple(given.values())
    if not kernels.compiled:
        if key not in _interpreted:
            _interpreted[key] = _bind(
                {name: _direct(f) for name, f in given.items()}, lambda function: function, "", False
            )
        return _interpreted[key], np.zeros(0, np.int64)
    from numba import njit, typeof

    data, work = problem.data, problem.workspace()
    key = (*key, typeof(data), typeof(work))
    if key not in _compiled:
        from .addresses import addresses, callers

        sources = (Path(str(source.__file__)), Path(__file__).with_name("addresses.py"))
        own = hashlib.blake2b(b"".join(path.read_bytes() for path in sources), digest_size=4).hexdigest()
        digest = f"{kernels_digest(kernels)}_{own}"
        made = _bind(callers(), njit(cache=True, **OPTIONS), f"_{digest}", True, digest)
        _compiled[key] = made, addresses(given, data, work, digest)
    return _compiled[key]


def _bind(
    known: dict[str, Any], compile_: Callable[[Any], Any], suffix: str, compiled: bool, digest: str = ""
) -> Kernels:
    known = dict(known)
    for name in HELPERS:
        known[name] = compile_(copy_with(getattr(source, name), suffix, **known))
    parts = [
        compile_(copy_with(getattr(source, f"locus_{name}"), suffix, **known))
        for name in ("linearise", "bordered", "inspect")
    ]
    return Kernels(*parts, compiled=compiled, digest=digest)


@cache
def _direct(function: Callable[..., Any]) -> Callable[..., Any]:
    """An interpreted kernel, which needs no address."""

    def call(calls: Any, *arguments: Any) -> Any:
        return function(*arguments)

    return call
