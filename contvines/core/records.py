"""Structs of the native core, made from named tuples: arrays become pointers, integers int64, floats double."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from .library import NUMBER, POINTER, WHOLE, address


def structure(kind: type[NamedTuple] | Any) -> type[ctypes.Structure]:
    """The struct whose members are the fields of a named tuple class, in their order.

    Fields are annotated as float, int or ndarray; every other type is a pointer, given as an address.
    """
    types = {float: NUMBER, int: WHOLE}
    hints = get_type_hints(kind)
    members = [(name, types.get(hints[name], POINTER)) for name in kind._fields]
    return type(kind.__name__, (ctypes.Structure,), {"_fields_": members})


def record(form: type[ctypes.Structure], values: Sequence[Any]) -> ctypes.Structure:
    """A struct filled from a named tuple; it keeps the arrays to which it points alive.

    Raises
    ------
    TypeError
        If an array is not C-contiguous, or of other numbers than float64 and int64.
    """
    made = form(*(_plain(value) for value in values))
    made.kept = values  # type: ignore[attr-defined]
    return made


def _plain(value: Any) -> Any:
    if not isinstance(value, np.ndarray):
        return value
    if not value.flags.c_contiguous or value.dtype not in (np.float64, np.int64):
        raise TypeError(
            f"an array of {value.dtype}, strides {value.strides}, cannot be handed to the native core"
        )
    return address(value)
