"""Compiled functions that other compiled functions call, and nobody else.

Of each function numba makes machine code, and a wrapper by which Python calls it. A function that is inlined where it is called needs neither:
that is half of what it costs to compile. `part` compiles to optimised intermediate code only, which is linked into the callers. Called
from Python all the same, a part is compiled once more, as a whole.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core import config

Part: Any
MAKER: dict[str, Any]
try:
    from contvines_ground.compiler import Compiler
    from contvines_ground.linked import Part

    MAKER = {"pipeline_class": Compiler}
except (
    ImportError,
    AttributeError,
):  # a numba with other inner rooms: parts are functions like any, and all take longer to compile
    Part, MAKER = None, {}


def part(**options: Any) -> Callable[[Any], Any]:
    """Decorator of functions that other compiled functions call.

    Parameters
    ----------
    **options
        Of `numba.njit`, but for `cache` and `inline`.
    """

    def decorate(function: Any) -> Any:
        if getattr(config, "DISABLE_JIT", False):
            return function
        return njit(**options)(function) if Part is None else Part(function, None, options)

    return decorate


def from_python(function: Any, caller: Any) -> Any:
    """The part, and `caller`, a compiled function that does nothing but call it, for whoever calls it from Python all the same."""
    if Part is not None and isinstance(function, Part):
        function.called_by(caller)
    return function


def whole(*signature: Any, **options: Any) -> Callable[[Any], Any]:
    """Decorator of functions that Python calls: `numba.njit`, which takes less time.

    Parameters
    ----------
    *signature
        To compile at once.
    **options
        Of `numba.njit`.
    """
    return njit(*signature, **MAKER, **options)
