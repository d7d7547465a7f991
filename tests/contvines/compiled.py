"""Compiled problems for tests: tables of C functions that call Python back."""

import ctypes
from types import SimpleNamespace

import numpy as np

from contvines.core.table import _PROTOTYPES, TableKernels


class Made(TableKernels):
    """Kernels from three Python functions ``(data, u, p, work)`` and so on, of data and workspaces that are arrays of fixed sizes.

    Parameters
    ----------
    linearise, bordered, inspect : callable
    sizes : (int, int, int, int)
        Numbers of entries of data, unknowns, workspace and row.
    """

    def __init__(self, linearise, bordered, inspect, sizes):
        data_size, n, work_size, row = sizes

        def array(at, size):
            return np.ctypeslib.as_array((ctypes.c_double * size).from_address(at)) if size else np.zeros(0)

        def one(data, u, p, work):
            return linearise(array(data, data_size), array(u, n), p, array(work, work_size))

        def two(data, work, border, target, step, tangent):
            lines = [array(at, n + 1) for at in (border, step, tangent)]
            return bordered(array(data, data_size), array(work, work_size), lines[0], target, *lines[1:])

        def three(data, u, p, work, out):
            inspect(array(data, data_size), array(u, n), p, array(work, work_size), array(out, row))

        self.calls = [make(f) for make, f in zip(_PROTOTYPES, (one, two, three))]
        self.places = (ctypes.c_void_p * 6)(
            *(ctypes.cast(call, ctypes.c_void_p).value for call in self.calls)
        )
        super().__init__(ctypes.addressof(self.places))


def in_memory(*values):
    """Numbers where a table finds them."""
    return SimpleNamespace(memory=np.array(values, dtype=float))
