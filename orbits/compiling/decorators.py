"""How compiled functions are compiled.

Kernels allocate nothing, so they do without reference counts: a kernel gets a tuple of a dozen arrays, and counting
them in and out of every call costs more than the mathematics of a short word. They are inlined where they are called.
"""

from __future__ import annotations

from typing import Any

from numba import njit

OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}

kernel = njit(forceinline=True, **OPTIONS)
"""Decorator of functions that other compiled functions call."""

stored_kernel = njit(cache=True, **OPTIONS)
"""Decorator of functions that are called from Python as well, and kept on disk."""

inlined_kernel = njit(cache=True, forceinline=True, **OPTIONS)
"""Decorator of functions that other compiled functions call, and that are kept on disk by themselves."""
