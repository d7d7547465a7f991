"""What a locus in a second parameter, or a normal form, asks of equations with a sparse Jacobian beside solving them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..functions import Operator
from ..nearness import LARGEST

if TYPE_CHECKING:
    from ..interpreted import Equations
    from .sparse_work import SparseWork


def flip(data: Equations, work: SparseWork, sign: float) -> None:
    """Nothing: what has a sparse Jacobian is no map."""


def transpose(data: Equations, work: SparseWork, column: np.ndarray, other: SparseWork) -> None:
    """The transposed Jacobian, with another last column, into another workspace."""
    if isinstance(work.jacobian, Operator):
        raise ValueError(
            "loci need the transposed Jacobian: give it as an array or a sparse matrix, not as a LinearOperator"
        )
    other.jacobian, other.factors, other.failed = work.matrix.T.tocsc(), None, False
    other.derivative[:] = column


def matrix(data: Equations, work: SparseWork) -> np.ndarray:
    """F_u as it stands in a workspace, dense."""
    if len(work.residual) > LARGEST or isinstance(work.jacobian, Operator):
        raise ValueError(f"it needs the matrix of F_u, of up to {LARGEST} unknowns")
    return work.matrix.toarray()
