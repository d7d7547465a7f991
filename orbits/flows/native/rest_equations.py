"""The equations of the empty word: the absorber at rest, linear equations with one margin (`orbits.machines.rest`)."""

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
    """The unknowns are those of the machine's `rest`; there are no nodes, no flights and no impacts."""

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
        """In plain Python: there are three equations."""
        return KERNELS

    def workspace(self) -> RestWork:
        """Residual, Jacobian and derivative with respect to the parameter."""
        n = self.dimension
        return np.zeros(n), np.zeros((n, n)), np.zeros(n)

    def through_flights(self, u: np.ndarray, p: float) -> None:
        """None."""

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """No nodes."""
        return np.zeros((*np.shape(u)[:-1], 0, self.model.node))

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """The unknowns, which follow from the parameters alone."""
        return self.model.rest.solved(self.params)


class RestKernels(PlainKernels[RestEquations, RestWork]):
    """What a continuation, a locus of its border, and Newton's method call."""

    column = 2
    flip = None  # the unknowns hold no perturbations that could change sign
    matrix = None
    assign = staticmethod(assign)

    def linearise(self, data: RestEquations, u: np.ndarray, p: float, work: RestWork) -> float:
        """F = K u - f, its Jacobian K, and its derivative by the parameter from central differences."""
        F, J, Q = work
        K, f = data.model.rest.equations(data.values(p))
        J[:] = K
        F[:] = K @ u - f
        h = SOLVING.shift * (abs(p) or 1.0)  # whatever the unit of p
        ahead, f_ahead = data.model.rest.equations(data.values(p + h))
        behind, f_behind = data.model.rest.equations(data.values(p - h))
        Q[:] = ((ahead @ u - f_ahead) - (behind @ u - f_behind)) / (2.0 * h)
        return float(np.abs(F).max())

    def fill(self, data: RestEquations, work: RestWork, matrix: np.ndarray) -> None:
        """K."""
        matrix[:] = work[1]

    def inspect(self, data: RestEquations, u: np.ndarray, p: float, work: RestWork, row: np.ndarray) -> None:
        """Multipliers of the forcing period, and the reserve of friction."""
        params = data.values(p)
        spectrum = data.model.rest.multipliers(params)
        row[: 2 * spectrum.size].view(np.complex128)[:] = spectrum
        row[-1] = data.model.rest.reserve(params, u)

    @staticmethod
    def transpose(data: RestEquations, work: RestWork, column: np.ndarray, other: RestWork) -> None:
        """The transposed Jacobian, with another last column, into another workspace."""
        other[1][:], other[2][:] = work[1].T, column


KERNELS = RestKernels()
