"""The equations of the empty word: the absorber at rest, with linear equations and one margin (`orbits.machines.rest`)."""

from __future__ import annotations

import numpy as np

from orbits.flows.equations import Equations
from orbits.flows.plain_kernels import PlainKernels
from orbits.machines.base import Model
from orbits.machines.parameters import assign
from orbits.settings import SOLVING

RestWork = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Residual, Jacobian and derivative by the parameter."""


class RestEquations(Equations[Model]):
    """Equations of the absorber at rest; the unknowns are those of the machine's `rest`: no nodes, flights or impacts."""

    length, n_margins = 0, 1
    twist, shift = 1.0, 2.0 * np.pi
    movable = False
    period_shift = None
    unit = np.ones((0, 1))

    def __init__(self, model: Model, parameter: str, params: np.ndarray) -> None:
        self.model, self.params, self.parameter = model, params.copy(), parameter
        self.path = model.path(parameter, params).copy()
        self.law, self.active = model.law, model.place_of(parameter)
        self.amounts = np.array(model.amounts(params), dtype=float) if len(self.law) else self.params
        self.dimension = model.rest.unknowns
        self.n_multipliers = model.rest.multipliers(params).size
        self.data = self

    @property
    def kernels(self) -> RestKernels:
        """Kernels in plain Python: there are only three equations."""
        return KERNELS

    def workspace(self) -> RestWork:
        """Return arrays for residual, Jacobian and derivative by the parameter."""
        n = self.dimension
        return np.zeros(n), np.zeros((n, n)), np.zeros(n)

    def through_flights(self, u: np.ndarray, p: float) -> None:
        """Return None: there are no flights."""

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Return an array without nodes."""
        return np.zeros((*np.shape(u)[:-1], 0, self.model.node))

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Return the unknowns, which follow from the parameters alone."""
        return self.model.rest.solved(self.params)


class RestKernels(PlainKernels[RestEquations, RestWork]):
    """Kernels for a continuation, for a locus of the border, and for Newton's method."""

    column = 2
    flip = None  # a rest has no perturbations over a period that could change sign
    matrix = None
    assign = staticmethod(assign)

    def linearise(self, data: RestEquations, u: np.ndarray, p: float, work: RestWork) -> float:
        """Write F = K u - f, its Jacobian K and its derivative by the parameter (central differences) into `work`."""
        F, J, Q = work
        K, f = data.model.rest.equations(data.values(p))
        J[:] = K
        F[:] = K @ u - f
        h = SOLVING.shift * (abs(p) or 1.0)  # relative to p, whatever its unit
        ahead, f_ahead = data.model.rest.equations(data.values(p + h))
        behind, f_behind = data.model.rest.equations(data.values(p - h))
        Q[:] = ((ahead @ u - f_ahead) - (behind @ u - f_behind)) / (2.0 * h)
        return float(np.abs(F).max())

    def fill(self, data: RestEquations, work: RestWork, matrix: np.ndarray) -> None:
        """Write K into `matrix`."""
        matrix[:] = work[1]

    def inspect(self, data: RestEquations, u: np.ndarray, p: float, work: RestWork, row: np.ndarray) -> None:
        """Write the multipliers of the forcing period and the reserve of friction into `row`."""
        params = data.values(p)
        spectrum = data.model.rest.multipliers(params)
        row[: 2 * spectrum.size].view(np.complex128)[:] = spectrum
        row[-1] = data.model.rest.reserve(params, u)

    @staticmethod
    def transpose(data: RestEquations, work: RestWork, column: np.ndarray, other: RestWork) -> None:
        """Write the transposed Jacobian, with another last column, into another workspace."""
        other[1][:], other[2][:] = work[1].T, column


KERNELS = RestKernels()
