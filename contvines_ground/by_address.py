"""Compiled functions called by address, and tuples of arrays that stand at an address.

To hand over the three dozen arrays of a problem's data and workspace takes longer than to solve for a point of a short word. So the
compiled form of a tuple is written to a piece of memory, and compiled code is given the address. A function at an address is no part
of the code that calls it, which then is the same for all problems.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.core.registry import cpu_target
from numba.extending import intrinsic

WHOLE, NUMBER, VECTOR, NOTHING = types.int64, types.float64, types.Array(types.float64, 1, "C"), types.none


def _pointer(context: Any, builder: Any, address: Any, kind: Any) -> Any:
    return builder.inttoptr(address, context.get_data_type(kind).as_pointer())


@intrinsic
def _save(typingctx: Any, address: Any, content: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = signature.args[1]
        context.pack_value(builder, kind, arguments[1], _pointer(context, builder, arguments[0], kind))
        return ir.Constant(ir.IntType(64), 0)

    return types.int64(types.int64, content), generate


save: Any = _save
"""(address, tuple): write the tuple there, in compiled code."""


def loader(kind: Any) -> Any:
    """What gives back, in compiled code, the tuple of a type that stands at an address."""

    @intrinsic
    def load(typingctx: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return context.unpack_value(builder, kind, _pointer(context, builder, arguments[0], kind))

        return kind(types.int64), generate

    return load


def room_for(kind: Any) -> int:
    """Bytes that a tuple of a type takes."""
    context: Any = cpu_target.target_context
    return context.get_abi_sizeof(context.get_data_type(kind))


def caller(result: Any, *kinds: Any) -> Any:
    """What calls, in compiled code, a compiled function: (address, *arguments) -> result, by numba's own convention.

    The arguments have to be of these very types; an address does not tell what is there.
    """

    @intrinsic
    def call(typingctx: Any, address: Any, *arguments: Any) -> Any:
        given = arguments[0].types if len(arguments) == 1 and hasattr(arguments[0], "types") else arguments
        given = tuple(given)
        if kinds and given != kinds:
            raise TypingError(f"called by address with {given} in place of {kinds}")

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            parts = [builder.extract_value(values[1], i) for i in range(len(given))]
            kind = context.call_conv.get_function_type(result, given)
            pointer = builder.inttoptr(values[0], kind.as_pointer())
            status, found = context.call_conv.call_function(builder, pointer, result, given, parts)
            with cgutils.if_unlikely(builder, status.is_error):
                context.call_conv.return_status_propagate(builder, status)
            return found

        return result(types.int64, types.StarArgTuple(given)), generate

    return call


@cache
def own_digest() -> str:
    """Of this file: numba looks only at the one that defines a function, not at what it calls."""
    return hashlib.blake2b(Path(__file__).read_bytes(), digest_size=4).hexdigest()


_alive: list[Any] = []  # compiled code lives as long as this


def address_of(function: Any, *kinds: Any) -> int:
    """Where the compiled function for these types of arguments is in this process."""
    function.compile(kinds)
    overload = function.overloads[kinds]
    _alive.append(function)
    return overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name)
