"""How compiled functions are compiled.

Kernels allocate nothing, so they do without reference counts: a kernel gets a tuple of a dozen arrays, and counting
them in and out of every call costs more than the mathematics of a short word. They are inlined where they are called.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from contvines_ground.parts import part, whole

OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

kernel = part(forceinline=True, **OPTIONS)
"""Decorator of functions that other compiled functions call."""

stored_kernel = whole(cache=True, **OPTIONS)
"""Decorator of functions that are called from Python as well, and kept on disk."""

inlined_kernel = whole(cache=True, forceinline=True, **OPTIONS)
"""Decorator of functions that other compiled functions call, and that are kept on disk by themselves."""


def digest_of(*modules: ModuleType, size: int = 6) -> str:
    """A digest of the sources of some modules: what is kept on disk is good for these only."""
    files = [str(module.__file__) for module in modules]
    return hashlib.blake2b(b"".join(Path(file).read_bytes() for file in files), digest_size=size).hexdigest()


def stored_with(*modules: ModuleType, **options: Any) -> Callable[[Callable], Any]:
    """Decorator of functions that are kept on disk and call compiled functions of other files.

    numba looks at the file of the function alone; here the sources of `modules` are part of the name under which it is kept.
    """
    digest = digest_of(*modules)

    def decorate(function: Callable) -> Any:
        function.__qualname__ = f"{function.__name__}_{digest}"
        return whole(cache=True, error_model="numpy", **options)(function)

    return decorate


def specialise(
    function: Callable, name: str, inline: bool = False, options: dict[str, Any] | None = None, **known: Any
) -> Any:
    """A compiled copy of `function` that sees `known` in place of its module's globals, cached on disk under `name`.

    numba cannot find a closure over compiled functions again in its cache, but it finds a function by its name: `name`
    must tell all of `known` apart (a digest of their sources does).
    """
    qualified = f"{function.__name__.strip('_')}_{name}"
    copy = FunctionType(function.__code__, {**function.__globals__, **known}, qualified)
    copy.__qualname__ = qualified
    copy.__module__ = function.__module__
    if options is not None:
        return whole(cache=True, **options)(copy)
    return (inlined_kernel if inline else stored_kernel)(copy)
