"""Curves in the plane, interpreted and compiled: a table of C functions that call Python back."""

import ctypes
from types import SimpleNamespace

import numpy as np
import pytest

from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.continuation.starts import solve_start
from contvines.continuation.trace import chunks
from contvines.core.library import native
from contvines.core.table import _PROTOTYPES, TableKernels
from contvines.problems.protocol import Kernels, ProblemDefaults


def linearise(data, u, p, work):
    square, other, linear, slope, constant, wrong = data
    work[0] = square * u[0] * u[0] + other * p * p + linear * u[0] + slope * p + constant
    work[1] = (2.0 * square * u[0] + linear) * (1.0 + wrong)
    work[2] = 2.0 * other * p + slope
    return abs(work[0])


def bordered(data, work, border, n, step, tangent):
    F, J, Q = work
    det = J * border[1] - Q * border[0]
    step[0] = (-F * border[1] - Q * n) / det
    step[1] = (J * n + F * border[0]) / det
    tangent[0] = -Q / det
    tangent[1] = J / det
    return 1.0 if det > 0.0 else -1.0


def inspect(data, u, p, work, row):
    row[0] = 1.0 + u[0]
    row[1] = 0.0


def array(at, size):
    return np.ctypeslib.as_array((ctypes.c_double * size).from_address(at))


class Compiled(TableKernels):
    def __init__(self):
        functions = (
            lambda data, u, p, work: linearise(array(data, 6), array(u, 1), p, array(work, 3)),
            lambda data, work, border, n, step, tangent: bordered(
                data, array(work, 3), array(border, 2), n, array(step, 2), array(tangent, 2)
            ),
            lambda data, u, p, work, row: inspect(data, array(u, 1), p, work, array(row, 2)),
        )
        self.calls = [make(f) for make, f in zip(_PROTOTYPES, functions)]
        self.places = (ctypes.c_void_p * 6)(
            *(ctypes.cast(call, ctypes.c_void_p).value for call in self.calls)
        )
        super().__init__(ctypes.addressof(self.places))


class Curve(ProblemDefaults):
    """a u^2 + b p^2 + c u + d p + e = 0, a multiplier 1 + u, and a derivative by u that is wrong by a share."""

    dimension, n_multipliers, spectrum, parameter = 1, 1, "map", "p"

    def __init__(self, kernels, *data, start):
        self.kernels, (u, self.p0) = kernels, start
        self.u0 = np.array([u])
        self.data = self._kept(data)

    def workspace(self):
        return self._kept(np.zeros(3))

    def _kept(self, values):
        values = np.array(values, dtype=float)
        return SimpleNamespace(memory=values) if self.kernels.compiled else values

    def engine(self, within, **settings):
        return Engine(self, within, Settings(**settings))

    def chunks(self, within, **settings):
        engine = self.engine(within, **settings)
        return list(chunks(engine, solve_start(engine, self.u0, self.p0)))


INTERPRETED = Kernels(linearise, bordered, inspect)
KERNELS = {"interpreted": INTERPRETED} | ({"compiled": Compiled()} if native() else {})
each = pytest.mark.parametrize("kernels", KERNELS.values(), ids=KERNELS)


def circle(kernels):
    """u^2 + p^2 = 1, whose multiplier passes 1 at the folds."""
    return Curve(kernels, 1.0, 1.0, 0.0, 0.0, -1.0, 0.0, start=(1.0, 0.0))


def line(kernels, wrong=0.0):
    """u = p."""
    return Curve(kernels, 0.0, 0.0, 1.0, -1.0, 0.0, wrong, start=(0.0, 0.0))
