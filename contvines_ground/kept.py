"""Arguments that stay the same from call to call, handed to compiled code once; see `contvines_ground.by_address`."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np
from numba import typeof, types  # pyright: ignore[reportPrivateImportUsage]

from contvines_ground.by_address import room_for, save
from contvines_ground.parts import whole

OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}
"""Of the compiler; without reference counts, which nobody would keep for the arrays at an address."""

Maker = Callable[[Any, str], Any]


class Keeper:
    """Keeps tuples for compiled code.

    Parameters
    ----------
    make : callable
        From the type of a kept tuple to the code that is given its address; and from a mark of the type, which the name of
        that code has to carry: an address has no type by which what is on disk could be told apart.
    suffix : str
        Under which what is compiled here is kept on disk.
    """

    def __init__(self, make: Maker, suffix: str) -> None:
        self.make, self.suffix = make, suffix
        self.known: list[tuple[int, Callable[..., Any], Any]] = []

    def keep(self, content: tuple[Any, ...]) -> tuple[Any, int, np.ndarray] | None:
        """The code for such tuples, the address of this one, and the memory in which it stands now.

        Its arrays have to be kept elsewhere. None for a tuple of anything but numbers, arrays and tuples of these.
        """
        for size, write, made in self.known:
            memory = np.empty(size)
            address = memory.ctypes.data
            try:
                write(address, content)
            except TypeError:
                continue  # of another type
            return made, address, memory
        kind = typeof(content)
        if not _plain(kind):
            return None
        mark = "_" + hashlib.blake2b(str(kind).encode(), digest_size=4).hexdigest()
        # a copy, as numba would take a closure over an intrinsic for another function in every process
        write: Any = FunctionType(_write.__code__, _write.__globals__, f"save_{self.suffix}{mark}")
        write.__qualname__, write.__module__ = write.__name__, __name__
        compiled: Any = whole(types.int64(types.int64, kind), cache=True, **OPTIONS)
        self.known.append((-(-room_for(kind) // 8), compiled(write), self.make(kind, mark)))
        return self.keep(content)


def _write(address, content):
    return save(address, content)


def _plain(kind: Any) -> bool:
    """Whether a type's compiled form is all there is to it, beside the arrays' own memory."""
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        return all(_plain(part) for part in parts)
    return isinstance(kind, types.Array | types.Number | types.Boolean | types.NoneType)
