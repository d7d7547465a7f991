"""Data and arrays of the kernels of a locus; ``memory`` of either is the struct of that name in native/loci.hpp."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..core.records import pack
from ..core.table import memory_of
from ..problems.protocol import KernelFunctions, array_of
from .layout import LONGEST

if TYPE_CHECKING:
    from .problem import LocusProblem

NOTHING = np.zeros(0)


class Data(NamedTuple):
    """What the kernels know of a locus."""

    first: object
    second: object
    calls: KernelFunctions
    kind: int
    which: int
    multipliers: int
    flow: bool
    unit: float
    memory: np.ndarray = NOTHING


class Work:
    """Arrays of the kernels, in the order of the native struct."""

    memory = NOTHING

    def __init__(self, locus: LocusProblem) -> None:
        problem, n, size = locus.base, locus.size, locus.dimension
        column, tests = problem.kernels.column, max(size - n, 2)
        self.base, self.trial = locus.first.workspace(), locus.first.workspace()
        self.residual = np.zeros(size)
        self.base_F, self.base_Q = array_of(self.base).reshape(-1), array_of(self.base, column).reshape(-1)
        self.trial_F, self.trial_Q = (
            array_of(self.trial).reshape(-1),
            array_of(self.trial, column).reshape(-1),
        )
        self.point = np.zeros(size + 1)
        self.columns = np.zeros((2, n))
        self.solutions = np.zeros((6, n + 1))
        self.directions = np.zeros((4, size + 1))
        self.borders = locus.borders.copy()
        self.row = np.zeros(2 * problem.n_multipliers + problem.n_margins)
        self.shifted = np.zeros(n + 1)
        self.scales = locus.sizes
        self.values, self.slopes = np.zeros((2, tests))
        self.lines = np.zeros((2, n + 1))
        self.reference = np.array(
            [locus.reference, 0.0, 0.0, *(bound / locus.unit for bound in locus.bounds)]
        )
        self.small = np.zeros((3, 5))
        self.masked = np.array(locus.masked, np.int64).reshape(-1)
        self.rows = locus.rows
        self.frozen = np.zeros(size + 1)
        self.steep = np.zeros((3, tests))
        self.state = np.array([-1.0, 1.0, 0.0, LONGEST])
        self.frame = np.random.default_rng(7).standard_normal(n + 1) / np.sqrt(n)
        self.kept = np.zeros(size)
        if locus.compiled:
            arrays = [part for part in vars(self).values() if isinstance(part, np.ndarray)]
            places = memory_of(self.base), memory_of(self.trial)
            self.memory = pack(n, size, len(self.masked), *places, *arrays, len(self.row))

    def __getitem__(self, place: int) -> np.ndarray:
        return (self.residual,)[place]
