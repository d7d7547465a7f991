"""Arguments that stay the same from call to call, handed to compiled code once.

To hand over the three dozen arrays of a problem's data and workspace takes longer than to solve for a point of a short word. So the
compiled form of the whole tuple is written to a piece of memory, and calls are given the address.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, typeof, types  # pyright: ignore[reportPrivateImportUsage]
from numba.core.registry import cpu_target
from numba.extending import intrinsic

from contvines_ground.parts import part

Maker = Callable[[Any, str], Callable[..., Any]]


def _pointer(context: Any, builder: Any, address: Any, kind: Any) -> Any:
    return builder.inttoptr(address, context.get_data_type(kind).as_pointer())


@intrinsic
def _save(typingctx: Any, address: Any, frame: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = signature.args[1]
        context.pack_value(builder, kind, arguments[1], _pointer(context, builder, arguments[0], kind))
        return ir.Constant(ir.IntType(64), 0)

    return types.int64(types.int64, frame), generate


def _loader(kind: Any) -> Any:
    """What gives back, in compiled code, a tuple of a type that stands at an address."""

    @intrinsic
    def load(typingctx: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return context.unpack_value(builder, kind, _pointer(context, builder, arguments[0], kind))

        return kind(types.int64), generate

    return load


class Keeper:
    """Keeps tuples for the compiled functions of one set of kernels.

    Parameters
    ----------
    make : callable
        From what unpacks a kept tuple to the compiled function, whose first argument is its address; and from a mark of the
        tuple's type, which the name has to carry: an address has no type by which what is on disk could be told apart.
    options : dict
        Of the compiler; without reference counts, which nobody would keep for the arrays at an address.
    suffix : str
        Under which what is compiled here is kept on disk.
    """

    def __init__(self, make: Maker, options: dict[str, Any], suffix: str) -> None:
        self.make, self.options, self.suffix = make, options, suffix
        self.known: list[tuple[int, Callable[..., Any], Callable[..., Any]]] = []
        self.plain: Callable[..., Any] | None = None

    def keep(self, frame: tuple[Any, ...]) -> tuple[Callable[..., Any], Any, np.ndarray | None]:
        """The function for such tuples, its first argument, and the memory in which this tuple stands now.

        Its arrays have to be kept elsewhere. A tuple of anything but numbers, arrays and tuples of these is handed over itself.
        """
        for size, save, function in self.known:
            memory = np.empty(size)
            try:
                save(memory.ctypes.data, frame)
            except TypeError:
                continue  # of another type
            return function, memory.ctypes.data, memory
        kind = typeof(frame)
        if not _plain(kind):
            if self.plain is None:
                itself: Any = part(**self.options)
                self.plain = self.make(itself(_itself), "")
            return self.plain, frame, None
        context: Any = cpu_target.target_context
        size = -(-context.get_abi_sizeof(context.get_data_type(kind)) // 8)

        mark = "_" + hashlib.blake2b(str(kind).encode(), digest_size=4).hexdigest()
        # a copy, as numba would take a closure over an intrinsic for another function in every process
        save: Any = FunctionType(_write.__code__, _write.__globals__, f"save_{self.suffix}{mark}")
        save.__qualname__, save.__module__ = save.__name__, __name__
        compiled: Any = njit(types.int64(types.int64, kind), cache=True, **self.options)
        self.known.append((size, compiled(save), self.make(_loader(kind), mark)))
        return self.keep(frame)


def _write(address, frame):
    return _save(address, frame)  # pyright: ignore[reportCallIssue]


def _itself(frame):
    return frame


def _plain(kind: Any) -> bool:
    """Whether a type's compiled form is all there is to it, beside the arrays' own memory."""
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        return all(_plain(part) for part in parts)
    return isinstance(kind, types.Array | types.Number | types.Boolean | types.NoneType)
