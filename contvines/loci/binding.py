"""The kernels of a locus, made from those of the problem whose special points it collects.

Interpreted kernels are called as they are, compiled ones by address (:mod:`contvines.loci.addresses`).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from contvines_ground.by_address import own_digest

from ..continuation.binding import OPTIONS, copy_with
from ..problems.kernels import Kernels, kernels_digest
from ..problems.protocol import Problem
from . import kernels as source
from . import probing, spanning

HELPERS: tuple[Any, ...] = (
    probing.null_test,
    probing.flipped_test,
    probing.pair_of,
    probing.tests,
    probing.slopes_along,
    probing.frozen,
    spanning.rotate,
    spanning.turn,
    spanning.parted,
    spanning.plain_row,
    spanning.solve,
    spanning.span,
    spanning.particular,
    source.close,
    source.renew,
    source.worn,
)
NAMES = ("linearise", "bordered", "inspect", "assign", "flip", "transpose")
_interpreted: dict[tuple[Any, ...], Kernels] = {}
_addresses: dict[tuple[Any, ...], np.ndarray] = {}


def locus_kernels(problem: Problem) -> tuple[Kernels, np.ndarray]:
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
    from .addresses import addresses, sort_of, type_of

    data, work = problem.data, problem.workspace()
    key = (*key, sort_of(data), sort_of(work))
    if key not in _addresses:
        types = hashlib.blake2b(repr((type_of(data), type_of(work))).encode(), digest_size=4).hexdigest()
        _addresses[key] = addresses(given, data, work, f"{kernels_digest(kernels)}_{types}_{own_digest()}")
    return _compiled_once(), _addresses[key]


@cache
def _compiled_once() -> Kernels:
    """The compiled kernels of all loci."""
    from contvines_ground.parts import whole

    from .addresses import callers

    sources = [
        Path(__file__).with_name(f"{name}.py")
        for name in ("kernels", "probing", "spanning", "layout", "addresses")
    ]
    digest = hashlib.blake2b(b"".join(path.read_bytes() for path in sources), digest_size=6).hexdigest()
    digest += own_digest()
    return _bind(callers(), whole(cache=True, **OPTIONS), f"_{digest}", True, f"locus_{digest}")


def _bind(
    known: dict[str, Any], compile_: Callable[[Any], Any], suffix: str, compiled: bool, digest: str = ""
) -> Kernels:
    known = dict(known)
    for helper in HELPERS:
        known[helper.__name__] = compile_(copy_with(helper, suffix, **known))
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
