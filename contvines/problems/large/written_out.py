"""A Jacobian without a matrix, written out as a sparse one where that is less work than solving with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csc_array, hstack
from scipy.sparse.linalg import gmres

from ..settings import LINEAR

if TYPE_CHECKING:
    from ..functions import Operator

ALWAYS = 300  # unknowns up to which a matrix costs as many products as a solution without preconditioner
AT_MOST = 2000
SHARE = 4  # beyond ALWAYS: where GMRES needs more products than this part of the unknowns
CHUNK = 100  # columns at a time


def worth_it(operator: Operator, n: int) -> bool:
    """Whether N products for a matrix are less work than GMRES without a preconditioner, judged by one solution."""
    if n <= ALWAYS or n > AT_MOST:
        return n <= ALWAYS
    with np.errstate(all="ignore"):
        side = np.random.default_rng(3).standard_normal(n)
        _, missed = gmres(operator, side, rtol=LINEAR.eigenvalues, atol=0.0, restart=n // SHARE, maxiter=1)
    return missed != 0


def written_out(operator: Operator, n: int) -> csc_array:
    """The matrix of an operator, from its products with unit vectors."""
    parts, unit = [], np.zeros(n)
    for first in range(0, n, CHUNK):
        columns = np.empty((n, min(CHUNK, n - first)))
        for j in range(columns.shape[1]):
            unit[first + j] = 1.0
            columns[:, j] = np.ravel(operator @ unit)
            unit[first + j] = 0.0
        parts.append(csc_array(columns))
    return csc_array(hstack(parts))
