"""`orbits.elimination.vectorised` called by address: compiled when the first long cycle asks for it.

Short words never need that code, so it is no part of the kernels that every run compiles. The arrays of a workspace
do not move: their addresses are listed once, and compiled code calls a function with the address of the list.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, types  # pyright: ignore[reportPrivateImportUsage]
from numba.extending import intrinsic

from contvines_ground.parts import MAKER
from orbits.compiling.decorators import digest_of
from orbits.compiling.waiting import Kept, wait_for
from orbits.elimination import closure, two_unknowns, vectorised
from orbits.elimination.two_unknowns import eliminate
from orbits.elimination.vectorised import ENDS, KEEP, LANES, PACK, STATE, condense, expand

FUNCTIONS, ARRAYS = 1, 14
UNLINKED = np.zeros(FUNCTIONS + ARRAYS, np.int64)  # of cycles that are too short to need them


@intrinsic
def _to_pointer(typingctx: Any, address: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.int64), generate


_pointer: Any = _to_pointer


@intrinsic
def _call_address(typingctx: Any, address: Any, length: Any, twist: Any, links: Any) -> Any:
    """Call the function at `address` with (length, twist, address of the list of addresses)."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole, number = ir.IntType(64), ir.DoubleType()
        kind = ir.FunctionType(number, [whole, number, whole])
        return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])

    return types.float64(types.int64, types.int64, types.float64, types.int64), generate


call: Any = _call_address


def _eliminate(length, twist, links):
    at = carray(_pointer(links), FUNCTIONS + ARRAYS, np.int64)
    nodes = LANES + length % LANES
    F = carray(_pointer(at[1]), (length, 2), np.float64)
    A = carray(_pointer(at[2]), (length, 2, 2), np.float64)
    D = carray(_pointer(at[3]), (length, 2, 2), np.float64)
    Q = carray(_pointer(at[4]), (length, 2), np.float64)
    scratch = carray(_pointer(at[5]), length // LANES * (PACK + KEEP) + STATE + ENDS, np.float64)
    short_F = carray(_pointer(at[6]), (nodes, 2), np.float64)
    short_A = carray(_pointer(at[7]), (nodes, 2, 2), np.float64)
    short_D = carray(_pointer(at[8]), (nodes, 2, 2), np.float64)
    short_Q = carray(_pointer(at[9]), (nodes, 2), np.float64)
    found = carray(_pointer(at[10]), (2, 2 * nodes + 1), np.float64)
    solution = carray(_pointer(at[11]), (2, 2 * length + 1), np.float64)
    stored = carray(_pointer(at[12]), (nodes, 2, 8), np.float64)
    small = carray(_pointer(at[13]), (2, 4), np.float64)
    order = carray(_pointer(at[14]), 3, np.int64)
    sign = condense(F, A, D, Q, scratch, (short_F, short_A, short_D, short_Q))
    sign *= eliminate(short_F, short_A, short_D, short_Q, twist, stored, small, order, found)
    expand(length, scratch, found, twist, solution)
    return sign


@cache
def function() -> Any:
    """The function that is called; a process that compiles beside this one is waited for."""
    # numba looks at this file only, not at those whose functions are called
    _eliminate.__qualname__ = f"eliminate_{digest_of(closure, two_unknowns, vectorised)}"
    wait_for(__name__, Kept(_eliminate))
    return cfunc(types.float64(types.int64, types.float64, types.int64), cache=True, **MAKER)(_eliminate)


def links(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """Addresses of the function and of F, A, D, Q, scratch, the shorter F, A, D, Q, found, solution, stored, small, order."""
    return np.array([function().address] + [array.ctypes.data for array in arrays], np.int64)
