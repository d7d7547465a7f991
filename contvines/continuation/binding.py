"""Binding the continuation loop to the kernels of a problem.

One source (march.py, corrector.py): ``bind`` copies the functions with other globals. What runs over the unknowns is taken
from lengths.py for compiled problems and from arrays.py for others. For compiled problems the copies are compiled and cached on disk under a name that carries a digest of the kernels' sources, so that a cached
loop is never older than the kernels in it.
"""

from __future__ import annotations

import hashlib
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from . import arrays, corrector, lengths
from . import march as loop


class Bound(NamedTuple):
    """``march`` and ``solve`` with the kernels of a problem inside."""

    march: Callable[..., Any]
    solve: Callable[..., Any]


# Kernels and loop allocate nothing, so they do without reference counts: counting the arrays of a workspace in
# and out of every call would cost more than the mathematics of a small problem.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

SUMS = ("correction_size", "add", "remainder", "fix_parameter", "plane", "compare", "put", "extrapolate")

_bound: dict[tuple[Any, ...], Bound] = {}


def copy_with(function: types.FunctionType, suffix: str = "", **names: Any) -> types.FunctionType:
    """The function with some of its globals replaced."""
    copy = types.FunctionType(
        function.__code__, {**function.__globals__, **names}, function.__name__, function.__defaults__
    )
    copy.__qualname__ = function.__qualname__ + suffix
    copy.__module__ = function.__module__
    copy.__doc__ = function.__doc__
    return copy


def bind(kernels: Any) -> Bound:
    """The continuation loop for these kernels; made once per set of kernels and process."""
    key = (kernels.linearise, kernels.bordered, kernels.inspect, bool(kernels.compiled))
    if key not in _bound:
        _bound[key] = _make(kernels)
    return _bound[key]


def _make(kernels: Any) -> Bound:
    functions = {"linearise": kernels.linearise, "bordered": kernels.bordered, "inspect": kernels.inspect}
    if not kernels.compiled:
        sums = {name: getattr(arrays, name) for name in SUMS}
        improve = copy_with(corrector.improve, **sums)
        correct = copy_with(corrector.correct, improve=improve, **sums, **functions)
        march = copy_with(loop.march, correct=correct, **sums, **functions)
        return Bound(march, copy_with(corrector.solve, improve=improve, **sums, **functions))
    from numba import njit

    from ..problems.protocol import kernels_digest

    suffix = f"_{kernels_digest(kernels)}_{_loop_digest()}"
    compile_ = njit(cache=True, forceinline=True, **OPTIONS)
    sums = {name: compile_(copy_with(getattr(lengths, name), suffix)) for name in SUMS}
    improve = compile_(copy_with(corrector.improve, suffix, **sums))
    correct = compile_(copy_with(corrector.correct, suffix, improve=improve, **sums, **functions))
    march = compile_(copy_with(loop.march, suffix, correct=correct, **sums, **functions))
    return Bound(march, compile_(copy_with(corrector.solve, suffix, improve=improve, **sums, **functions)))


def _loop_digest() -> str:
    """Of the loop's own files: numba looks only at the one that defines a function, not at what it calls."""
    digest = hashlib.blake2b(digest_size=4)
    for module in (corrector, lengths, loop):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()
