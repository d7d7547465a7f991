"""The workspace of kernels with a sparse Jacobian, or with none that is written out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import csc_array

from ..functions import Operator
from .sparse_factors import Factors, Method

if TYPE_CHECKING:
    from .matrix_free import Bordered


class Elimination(NamedTuple):
    """Factors, border, F_u^-1 F_p and Schur complement of a block elimination."""

    factors: Factors
    border: np.ndarray
    column: np.ndarray
    corner: float


@dataclass
class SparseWork:
    """F, F_u, F_p and the factors of F_u, made when they are first needed; `near` are those of the Jacobian before, if they are kept."""

    residual: np.ndarray
    derivative: np.ndarray
    jacobian: csc_array | Operator = field(default_factory=lambda: csc_array((0, 0)))
    factors: Factors | None = None
    near: Factors | None = None
    keep: bool = True
    failed: bool = False
    method: Method = field(default_factory=Method)
    eliminated: Elimination | None = None  # the last one
    iterated: Bordered | None = None  # the last bordered system of a matrix-free Jacobian
    distance: float = 1.0
    tangent: np.ndarray | None = None  # the last one of a matrix-free Jacobian, a guess of the next one

    @property
    def matrix(self) -> csc_array:
        """The Jacobian, where it is a matrix."""
        assert not isinstance(self.jacobian, Operator)
        return self.jacobian

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]
