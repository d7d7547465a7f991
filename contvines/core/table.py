"""Kernels of a compiled problem: a table of C functions behind one pointer (`Table` in native/api.h), called from Python and by native code.

The `data` and the workspaces of such a problem have an attribute ``memory``: an array whose address is passed to the functions.

Structs of the native core are numpy arrays (`pack`, `block`): every member has eight bytes, and arrays are pointers. The caller must keep
such an array, and all arrays to which it points, alive as long as native code uses its address.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache, lru_cache
from math import prod
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from .library import NOTHING, NUMBER, POINTER, WHOLE, address, function

if TYPE_CHECKING:
    from collections.abc import Callable


_PROTOTYPES = (
    ctypes.CFUNCTYPE(NUMBER, POINTER, POINTER, NUMBER, POINTER),
    ctypes.CFUNCTYPE(NUMBER, POINTER, POINTER, POINTER, NUMBER, POINTER, POINTER),
    ctypes.CFUNCTYPE(NOTHING, POINTER, POINTER, NUMBER, POINTER, POINTER),
    ctypes.CFUNCTYPE(NOTHING, POINTER, POINTER, NUMBER),
    ctypes.CFUNCTYPE(NOTHING, POINTER, POINTER, NUMBER),
    ctypes.CFUNCTYPE(NOTHING, POINTER, POINTER, POINTER, POINTER),
)
"""Signatures of linearise, bordered, inspect, assign, flip, transpose, in the order of the table."""


@runtime_checkable
class Struct(Protocol):
    """An object with a ``memory``, the array that the functions of a table read and write."""

    @property
    def memory(self) -> np.ndarray: ...


def memory_of(owner: object) -> int:
    """Return the address of the data or the workspace of a compiled problem.

    Raises
    ------
    TypeError
        If it has no memory that native code can read.
    """
    memory = getattr(
        owner, "memory", None
    )  # no isinstance test with a protocol, which is slow: this is called at every point
    if not isinstance(memory, np.ndarray):
        raise TypeError(f"a {type(owner).__name__} has no memory for the native core")
    return address(memory)


class TableKernels:
    """Kernels of a problem in native code; see `contvines.problems.protocol` for their contract.

    Parameters
    ----------
    table : int
        Address of the table. Its last three functions may be missing (null); the problem then has no loci in a second parameter.
    """

    compiled = True
    column = 3
    matrix: Callable[..., np.ndarray] | None = None

    def __init__(self, table: int) -> None:
        self.table = table
        addresses = (ctypes.c_void_p * len(_PROTOTYPES)).from_address(table)
        calls: list[Any] = [make(at) if at else None for make, at in zip(_PROTOTYPES, addresses)]
        self._linearise = calls[0]
        self._bordered = calls[1]
        self._inspect = calls[2]
        self._assign = calls[3]
        self._flip = calls[4]
        self._transpose = calls[5]
        loci = self._transpose is not None
        self.assign = self._assigned if loci else None
        self.flip = self._flipped if loci else None
        self.transpose = self._transposed if loci else None

    def linearise(self, data: Struct, u: np.ndarray, p: float, work: Struct) -> float:
        """Write residual and derivatives to `work`; return the largest residual."""
        u = np.ascontiguousarray(u, dtype=float)
        return self._linearise(address(data.memory), address(u), p, address(work.memory))

    def bordered(
        self,
        data: Struct,
        work: Struct,
        border: np.ndarray,
        target: float,
        step: np.ndarray,
        tangent: np.ndarray,
    ) -> float:
        """Solve the bordered system with the linearisation in `work`; return the determinant's sign."""
        border = np.ascontiguousarray(border, dtype=float)
        return self._bordered(
            address(data.memory), address(work.memory), address(border), target, place(step), place(tangent)
        )

    def inspect(self, data: Struct, u: np.ndarray, p: float, work: Struct, row: np.ndarray) -> None:
        """Write multipliers and margins of a solution to `row`."""
        u = np.ascontiguousarray(u, dtype=float)
        self._inspect(address(data.memory), address(u), p, address(work.memory), place(row))

    def _assigned(self, data: Struct, other: Struct, value: float) -> None:
        """Set in `data` the value of the parameter that varies in `other`."""
        self._assign(address(data.memory), address(other.memory), value)

    def _flipped(self, data: Struct, work: Struct, sign: float) -> None:
        """Multiply the closure condition in the linearisation by `sign`."""
        self._flip(address(data.memory), address(work.memory), sign)

    def _transposed(self, data: Struct, work: Struct, column: np.ndarray, other: Struct) -> None:
        """Write the transposed system, with `column` as its last column, to another workspace."""
        column = np.ascontiguousarray(column, dtype=float)
        self._transpose(address(data.memory), address(work.memory), address(column), address(other.memory))

    def newton(
        self,
        data: Struct,
        u: np.ndarray,
        p: float,
        work: Struct,
        border: np.ndarray,
        step: np.ndarray,
        tangent: np.ndarray,
        tolerance: float,
        limit: int,
    ) -> tuple[float, int, float]:
        """Solve by Newton's method at fixed p (or on the hyperplane of `border`), halving steps that do not reduce the residual.

        Parameters
        ----------
        data
            Of the problem.
        u : ndarray, shape (N,)
            Unknowns, changed in place.
        p : float
            Value of the parameter.
        work
            Workspace.
        border, step, tangent : ndarray, shape (N + 1,)
            The border row; last step and tangent are written to the other two.
        tolerance : float
            Largest size of the last correction.
        limit : int
            Largest number of iterations.

        Returns
        -------
        residual : float
            Largest residual; infinite without convergence.
        iterations : int
        p : float
        """
        value, count, room = NUMBER(p), WHOLE(0), np.empty(len(u))
        residual = _newton()(
            self.table,
            address(data.memory),
            address(work.memory),
            len(u),
            place(u),
            ctypes.addressof(value),
            address(room),
            place(border),
            place(step),
            place(tangent),
            tolerance,
            limit,
            ctypes.addressof(count),
        )
        return residual, count.value, value.value

    def examine(self, data: Struct, u: np.ndarray, p: float, work: Struct, row: np.ndarray) -> float:
        """Return the largest residual of a solution, and write its multipliers and margins to `row` as `inspect` does."""
        residual = self.linearise(data, u, p, work)
        self.inspect(data, u, p, work, row)
        return residual


@cache
def _newton() -> Callable[..., float]:
    return function("core_newton", NUMBER, *[POINTER] * 3, WHOLE, *[POINTER] * 6, NUMBER, WHOLE, POINTER)


@cache
def native_table(name: str, *number: int) -> int:
    """Return the address of a table of the native core; `name` is the function of native/core.cpp that returns it."""
    return int(function(name, POINTER, *[WHOLE] * len(number))(*number))


class KernelFunctions(Protocol):
    """Protocol of a problem's kernels, `contvines.problems.protocol.Kernels` or `TableKernels`; their contract is in `contvines.problems.protocol`."""

    @property
    def linearise(self) -> Callable[..., float]: ...
    @property
    def bordered(self) -> Callable[..., float]: ...
    @property
    def inspect(self) -> Callable[..., None]: ...
    @property
    def compiled(self) -> bool: ...
    @property
    def assign(self) -> Callable[..., None] | None: ...
    @property
    def flip(self) -> Callable[..., None] | None: ...
    @property
    def transpose(self) -> Callable[..., None] | None: ...
    @property
    def column(self) -> int: ...
    @property
    def matrix(self) -> Callable[..., np.ndarray] | None: ...


def pack(*members: float | np.ndarray) -> np.ndarray:
    """Return a struct made of its members, shape (k,): floats, integers, and arrays as pointers.

    Raises
    ------
    TypeError
        If an array is not C-contiguous, or its type is neither float64 nor int64.
    """
    struct = np.empty(len(members), np.int64)
    numbers = struct.view(np.float64)
    for i, member in enumerate(members):
        if isinstance(member, np.ndarray):
            struct[i] = place(member)
        elif isinstance(member, float):
            numbers[i] = member
        else:
            struct[i] = member
    return struct


def place(array: np.ndarray) -> int:
    """Return the address of an array after checking that native code can read it."""
    if not array.flags.c_contiguous or array.dtype not in (np.float64, np.int64):
        raise TypeError(
            f"an array of {array.dtype}, strides {array.strides}, cannot be handed to the native core"
        )
    return address(array)


@lru_cache(maxsize=1024)
def _layout(
    head: int, shapes: tuple[tuple[int, ...], ...]
) -> tuple[np.ndarray, tuple[tuple[int, int], ...], int]:
    ends = np.cumsum([head + len(shapes), *map(prod, shapes)])
    starts = ends[:-1]
    return 8 * starts, tuple(zip(starts.tolist(), ends[1:].tolist())), int(ends[-1])


def block(
    head: Sequence[float | int], shapes: tuple[tuple[int, ...], ...]
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Allocate one piece of memory with a struct and its arrays: the numbers of `head`, pointers to arrays, and these arrays, all zero.

    Parameters
    ----------
    head : sequence of int and float
        First members of the struct.
    shapes : tuple of shapes
        Of the arrays.

    Returns
    -------
    memory : ndarray of float64
        Its address is that of the struct.
    arrays : list of ndarray
        Views of the memory, float64.
    """
    places, parts, total = _layout(len(head), shapes)
    memory = np.zeros(total)
    whole, first = memory.view(np.int64), len(head)
    for i, number in enumerate(head):
        if isinstance(number, float):
            memory[i] = number
        else:
            whole[i] = number
    np.add(places, address(memory), out=whole[first : first + len(shapes)])
    return memory, [memory[a:b].reshape(shape) for (a, b), shape in zip(parts, shapes)]
