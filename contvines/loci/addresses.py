"""Compiled functions called by address, with the arguments that compiled code has at hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import njit, types, typeof  # pyright: ignore[reportPrivateImportUsage]
from numba.core import cgutils
from numba.extending import intrinsic

from ..continuation.binding import OPTIONS, copy_with

kernel: Any = None  # put in by `addresses`
by_address: Any = None  # put in by `callers`

VECTOR = types.Array(types.float64, 1, "C")


def _calls(result: Any) -> Any:
    """An intrinsic (address, *arguments) -> result that calls compiled code by numba's own convention."""

    @intrinsic
    def call(typingctx: Any, address: Any, *arguments: Any) -> Any:
        given = arguments[0].types if len(arguments) == 1 and hasattr(arguments[0], "types") else arguments

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
    """The six kernels, called by address; the first argument is the array of addresses."""
    number, nothing = _calls(types.float64), _calls(types.none)
    compile_ = njit(**OPTIONS)
    kinds = {linearise: number, bordered: number, inspect: nothing, assign: nothing}
    kinds |= {flip: nothing, transpose: nothing}
    return {f.__name__: compile_(copy_with(f, by_address=kind)) for f, kind in kinds.items()}


def _linearise(data, u, p, work):
    return kernel(data, u, p, work)


def _bordered(data, work, border, n, step, tangent):
    return kernel(data, work, border, n, step, tangent)


def _inspect(data, u, p, work, row):
    kernel(data, u, p, work, row)


def _assign(data, other, value):
    kernel(data, other, value)


def _flip(data, work, sign):
    kernel(data, work, sign)


def _transpose(data, work, column, other):
    kernel(data, work, column, other)


def addresses(kernels: dict[str, Any], data: Any, work: Any, digest: str) -> np.ndarray:
    """Where the compiled kernels of a problem are in this process, in the order of `callers`."""
    data_type, work_type, number = typeof(data), typeof(work), types.float64
    signatures = {
        _linearise: (data_type, VECTOR, number, work_type),
        _bordered: (data_type, work_type, VECTOR, number, VECTOR, VECTOR),
        _inspect: (data_type, VECTOR, number, work_type, VECTOR),
        _assign: (data_type, data_type, number),
        _flip: (data_type, work_type, number),
        _transpose: (data_type, work_type, VECTOR, work_type),
    }
    found = []
    for function, arguments in signatures.items():
        outlined = copy_with(function, f"_{digest}", kernel=kernels[function.__name__[1:]])
        compiled = njit(cache=True, **OPTIONS)(outlined)
        compiled.compile(arguments)
        overload = compiled.overloads[arguments]
        found.append(overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name))
        _kept.append(compiled)
    return np.array(found, np.int64)


_kept: list[Any] = []  # compiled code lives as long as this
