"""Structs of the native core in numpy arrays: every member has eight bytes, and arrays are pointers.

Native code is handed the address of such an array (`address`), which with all that it points to has to live as long as it is in use.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import prod

import numpy as np

from .library import address


def pack(*members: float | np.ndarray) -> np.ndarray:
    """A struct from its members, shape (k,): floats, integers, and arrays as pointers.

    Raises
    ------
    TypeError
        If an array is not C-contiguous, or of other numbers than float64 and int64.
    """
    made = np.empty(len(members), np.int64)
    numbers = made.view(np.float64)
    for i, member in enumerate(members):
        if isinstance(member, np.ndarray):
            made[i] = place(member)
        elif isinstance(member, float):
            numbers[i] = member
        else:
            made[i] = member
    return made


def place(array: np.ndarray) -> int:
    """Address of an array, which has to be one that native code can read."""
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
    """One piece of memory: a struct that begins with the numbers of `head`, pointers to arrays, and these arrays, all zero.

    Parameters
    ----------
    head : sequence of int and float
    shapes : tuple of shapes

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
