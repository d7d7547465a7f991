"""The kernels of a locus, made from those of the problem whose special points it collects."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from ..continuation.binding import OPTIONS, copy_with
from ..problems.protocol import Kernels, kernels_digest
from . import kernels as source

_HELPERS = ("null_test", "flipped_test", "pair_of", "tests", "slopes_along", "close", "renew")
_BASE = ("linearise", "bordered", "inspect", "assign", "flip", "transpose")
_made: dict[tuple[Any, ...], tuple[Kernels, Any]] = {}


def locus_kernels(kernels: Any) -> tuple[Kernels, Any]:
    """(kernels of the locus, the function `tests`) for a problem's kernels; made once per process."""
    key = tuple(getattr(kernels, name) for name in _BASE)
    if key not in _made:
        _made[key] = _make(kernels)
    return _made[key]


def _make(kernels: Any) -> tuple[Kernels, Any]:
    base = {name: getattr(kernels, name) for name in _BASE}
    compiled = bool(kernels.compiled)
    digest, suffix = "", ""
    if compiled:
        own = hashlib.blake2b(Path(str(source.__file__)).read_bytes(), digest_size=4).hexdigest()
        digest = f"{kernels_digest(kernels)}_{own}"
        suffix = f"_{digest}"

    def bound(name: str, **known: Any) -> Any:
        copy = copy_with(getattr(source, name), suffix, **known)
        if not compiled:
            return copy
        from numba import njit

        return njit(cache=True, **OPTIONS)(copy)

    # the problem's kernels are inlined where they are called: each into one function of its own
    known = {name: _outlined(kernels, name, suffix) if compiled else base[name] for name in _BASE}
    for name in _HELPERS:
        known[name] = bound(name, **known)
    parts = [bound(f"locus_{name}", **known) for name in ("linearise", "bordered", "inspect")]
    return Kernels(*parts, compiled=compiled, digest=digest), known["tests"]


def _outlined(kernels: Any, name: str, suffix: str) -> Any:
    from numba import njit

    from . import outlined

    return njit(cache=True, **OPTIONS)(
        copy_with(getattr(outlined, name), suffix, kernel=getattr(kernels, name))
    )
