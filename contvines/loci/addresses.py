"""A problem's compiled kernels, called by address with the addresses of their data and workspace.

A locus calls the kernels at many places. Each is one compiled function by itself, and what it works on stays where it is: the
tuples of arrays are stored once. The code of a locus is then the same for all problems and compiled once.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import njit, typeof  # pyright: ignore[reportPrivateImportUsage]

from contvines_ground.by_address import (
    NOTHING,
    NUMBER,
    VECTOR,
    WHOLE,
    address_of,
    caller,
    loader,
    room_for,
    save,
)
from contvines_ground.parts import part, whole

from ..continuation.binding import OPTIONS, copy_with

kernel: Any = None  # these are put in by `copy_with`
by_address: Any = None
data_at: Any = None
work_at: Any = None


# ------------------------------------------------------------------ tuples that stay where they are


@njit(**OPTIONS)
def _put(address, content):
    save(address, content)


_types: dict[Any, Any] = {}
_rooms: dict[Any, int] = {}


def type_of(content: Any) -> Any:
    """numba's type of a tuple of arrays and numbers, asked for once for each sort of content."""
    key = sort_of(content)
    found = _types.get(key)
    if found is None:
        found = _types[key] = typeof(content)
    return found


def sort_of(content: Any) -> Any:
    """What the type depends on; numba's types themselves are slow as keys."""
    if isinstance(content, np.ndarray):
        flags = content.flags
        return (
            content.dtype,
            content.ndim,
            flags.c_contiguous,
            flags.f_contiguous,
            flags.writeable,
            flags.aligned,
        )
    if isinstance(content, tuple):
        return type(content), tuple(map(sort_of, content))
    return type(content)


def _room_for(content: Any) -> int:
    """Bytes that a tuple takes."""
    key = sort_of(content)
    if key not in _rooms:
        _rooms[key] = room_for(type_of(content))
    return _rooms[key]


class Stored:
    """A tuple of arrays and numbers, stored for compiled code.

    Attributes
    ----------
    address : int
    """

    def __init__(self, content: Any) -> None:
        size = _room_for(content)
        self.content = content  # the arrays live as long as this
        self.room = np.zeros(size // 8 + 1)
        self.address = int(self.room.ctypes.data)
        _put(self.address, content)


# ------------------------------------------------------------------ the callers


def linearise(calls, data, u, p, work):
    """See the protocol."""
    return by_address(calls[0], data, u, p, work)


def bordered(calls, data, work, border, n, step, tangent):
    """See the protocol."""
    return by_address(calls[1], data, work, border, n, step, tangent)


def inspect(calls, data, u, p, work, row):
    """See the protocol."""
    by_address(calls[2], data, u, p, work, row)


def assign(calls, data, other, value):
    """See the protocol."""
    by_address(calls[3], data, other, value)


def flip(calls, data, work, sign):
    """See the protocol."""
    by_address(calls[4], data, work, sign)


def transpose(calls, data, work, column, other):
    """See the protocol."""
    by_address(calls[5], data, work, column, other)


@cache
def callers() -> dict[str, Any]:
    """The six kernels by name; the first argument is the array of addresses that `addresses` returns."""
    number, nothing = caller(NUMBER), caller(NOTHING)
    compile_ = part(**OPTIONS)
    kinds = {linearise: number, bordered: number, inspect: nothing, assign: nothing}
    kinds |= {flip: nothing, transpose: nothing}
    return {f.__name__: compile_(copy_with(f, by_address=kind)) for f, kind in kinds.items()}


# ------------------------------------------------------------------ what is called


def _linearise(data, u, p, work):
    return kernel(data_at(data), u, p, work_at(work))


def _bordered(data, work, border, n, step, tangent):
    return kernel(data_at(data), work_at(work), border, n, step, tangent)


def _inspect(data, u, p, work, row):
    kernel(data_at(data), u, p, work_at(work), row)


def _assign(data, other, value):
    kernel(data_at(data), data_at(other), value)


def _flip(data, work, sign):
    kernel(data_at(data), work_at(work), sign)


def _transpose(data, work, column, other):
    kernel(data_at(data), work_at(work), column, work_at(other))


def addresses(kernels: dict[str, Any], data: Any, work: Any, digest: str) -> np.ndarray:
    """Where the compiled kernels of a problem are in this process, in the order of `callers`.

    Parameters
    ----------
    kernels : dict
        By name.
    data, work : tuple
        Of the problem; only their types matter.
    digest : str
        Of the sources of the kernels.
    """
    signatures = {
        _linearise: (WHOLE, VECTOR, NUMBER, WHOLE),
        _bordered: (WHOLE, WHOLE, VECTOR, NUMBER, VECTOR, VECTOR),
        _inspect: (WHOLE, VECTOR, NUMBER, WHOLE, VECTOR),
        _assign: (WHOLE, WHOLE, NUMBER),
        _flip: (WHOLE, WHOLE, NUMBER),
        _transpose: (WHOLE, WHOLE, VECTOR, WHOLE),
    }
    loaders = {"data_at": loader(type_of(data)), "work_at": loader(type_of(work))}
    found = []
    for function, arguments in signatures.items():
        outlined = copy_with(function, f"_{digest}", kernel=kernels[function.__name__[1:]], **loaders)
        compiled = whole(cache=True, **OPTIONS)(outlined)
        found.append(address_of(compiled, *arguments))
    return np.array(found, np.int64)
