"""The native core's shared library: choice of the variant, and declaration of its functions.

The environment variable ``CONTVINES_CORE`` chooses the core: ``reference`` (no library), ``baseline`` or ``avx2`` (a variant of the
library). Without it the best variant for the processor is loaded; if no library can be loaded, a warning is printed and the reference
core is used.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from .build import SOURCES, digest, path_of, variants

WHOLE, NUMBER, POINTER, NOTHING = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p, None
"""C types of arguments and results; arrays are passed as pointers, see `address`."""

CHOICES = ("reference", "baseline", "avx2")


class Unusable(Exception):
    """A library cannot be used; the message gives the reason."""


@cache
def library() -> ctypes.CDLL | None:
    """Return the loaded library (`ctypes.CDLL`), or None if the reference core is used.

    Raises
    ------
    ValueError
        If ``CONTVINES_CORE`` has an unknown value.
    """
    choice = os.environ.get("CONTVINES_CORE", "")
    if choice == "reference":
        return None
    if choice and choice not in CHOICES:
        raise ValueError(f"CONTVINES_CORE={choice!r} is unknown; choose one of {', '.join(CHOICES)}")
    try:
        return _load(choice)
    except Unusable as error:
        print(f"contvines computes slowly, without its native core: {error}", file=sys.stderr)
        return None


def _load(choice: str) -> ctypes.CDLL:
    """Load the variant with a name, or the best one if the name is empty."""
    baseline = _open("baseline")
    if choice == "baseline" or "avx2" not in variants():
        return baseline
    baseline.core_avx2.restype = WHOLE
    if not baseline.core_avx2():
        if choice == "avx2":
            raise Unusable("CONTVINES_CORE=avx2, but this processor has no AVX2")
        return baseline
    try:
        return _open("avx2")
    except Unusable as error:
        if choice == "avx2":
            raise
        print(f"contvines computes with its slower variant: {error}", file=sys.stderr)
        return baseline


def _open(variant: str) -> ctypes.CDLL:
    path = path_of(variant)
    checkout = (SOURCES / "core.cpp").exists()
    advice = "run python -m contvines.core.build" if checkout else "install contvines again"
    if not path.exists():
        raise Unusable(f"{path} is missing; {advice}")
    if not _complete(path):
        raise Unusable(f"{path} is cut short; {advice}")
    try:
        found = ctypes.CDLL(str(path))
        assert found.core_digest
    except (OSError, AttributeError) as error:
        raise Unusable(f"{path} cannot be loaded ({error}); {advice}") from error
    found.core_digest.restype = ctypes.c_char_p
    if checkout and found.core_digest().decode() != digest():
        raise Unusable(f"{path} is older than its sources; {advice}")
    return found


def _complete(path: Path) -> bool:
    """Whether an ELF file is as long as its header states, from the table of sections at its end.

    The loaders of macOS and Windows check this themselves. That of Linux maps a truncated file, and an access to the missing part kills
    the process.
    """
    with path.open("rb") as file:
        head = file.read(64)
    if len(head) < 64 or head[:4] != b"\x7fELF":
        return True  # no ELF file: the loader will raise an error
    table, size, count = (int.from_bytes(head[i:j], sys.byteorder) for i, j in ((40, 48), (58, 60), (60, 62)))
    return path.stat().st_size >= table + size * count


def variant() -> str:
    """Return the name of the core in use: "reference", "baseline" or "avx2"."""
    found = library()
    if found is None:
        return "reference"
    return next(name for name in variants() if str(path_of(name)) == found._name)


def native() -> bool:
    """Whether the native core is in use."""
    return library() is not None


@cache
def function(name: str, result: type | None, *arguments: type) -> Callable[..., Any]:
    """Return a function of the library by name, declared with the types of its result and arguments."""
    found = library()
    if found is None:
        raise RuntimeError(f"{name} belongs to the native core, which is not loaded")
    declared = found[name]  # indexing returns a new object, not shared with other declarations
    declared.restype, declared.argtypes = result, arguments
    return declared


_Memory = ctypes.c_char * 0


def address(array: Any) -> int:
    """Return the address of the first element of a C-contiguous array."""
    try:
        return ctypes.addressof(_Memory.from_buffer(array))  # three times as fast as numpy's own attributes
    except (TypeError, BufferError):  # a read-only array
        return array.__array_interface__["data"][0]
