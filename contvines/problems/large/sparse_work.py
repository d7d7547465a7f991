"""The workspace of kernels with a sparse Jacobian, or with none that is written out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .sparse_factors import Method


@dataclass
class SparseWork:
    """F, F_u, F_p and the factors of F_u, made when they are first needed; `near` are those of the Jacobian before, if they are kept."""

    residual: np.ndarray
    derivative: np.ndarray
    jacobian: Any = None
    factors: Any = None
    near: Any = None
    keep: bool = True
    failed: bool = False
    method: Method = field(default_factory=Method)
    eliminated: Any = None  # factors, border, F_u^-1 F_p and Schur complement of the last block elimination
    distance: float = 1.0
    tangent: Any = None  # the last one of a matrix-free Jacobian, a guess of the next one

    def __getitem__(self, i: int) -> np.ndarray:
        return (self.residual, self.derivative)[i]
