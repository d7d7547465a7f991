"""Sparse Jacobians: by coloured differences, where columns that share no row are differentiated together, and from LinearOperators.

Curtis, Powell and Reid, On the estimation of sparse Jacobian matrices, J. Inst. Maths Applics 13 (1974) 117. scipy computes the groups.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse import csc_array, hstack
from scipy.sparse.linalg import gmres

from ..functions import Sparse
from ..settings import LINEAR

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..functions import Operator


class Colouring:
    """Groups of columns of a sparsity pattern that share no row.

    Parameters
    ----------
    pattern : sparse matrix or array, shape (n, n)
        Not zero where f_i depends on u_j.
    n : int

    Attributes
    ----------
    groups : ndarray of int, shape (n,)
        Group of each column.
    count : int
        Number of groups.

    Raises
    ------
    ValueError
        If the pattern has another shape.
    """

    def __init__(self, pattern: ArrayLike | Sparse, n: int) -> None:
        matrix = pattern if isinstance(pattern, Sparse) else sp.csc_array(np.asarray(pattern))
        from scipy.optimize._numdiff import group_columns  # a slow import that small problems do not need

        if matrix.shape != (n, n):
            raise ValueError(f"sparsity has shape {matrix.shape}; ({n}, {n}) is needed")
        matrix = sp.csc_matrix(matrix, copy=True)
        matrix.eliminate_zeros()
        matrix.sort_indices()
        self.indices, self.indptr, self.n = matrix.indices, matrix.indptr, n
        self.columns = np.repeat(np.arange(n), np.diff(matrix.indptr))
        matrix.data = np.ones_like(matrix.data, dtype=float)
        # the algorithm is greedy, so that the result depends on the order
        orders: tuple[Any, Any] = (0, np.arange(n))
        tries = [np.asarray(group_columns(matrix, order)) for order in orders]
        self.groups = min(tries, key=lambda groups: int(groups.max(initial=-1)))
        self.count = int(self.groups.max(initial=-1)) + 1

    def jacobian(self, along: Callable[[np.ndarray], np.ndarray]) -> sp.csc_array:
        """Return the matrix from the sums of its columns in each group.

        Parameters
        ----------
        along : callable
            (mask of columns, shape (n,)) -> the sum of these columns, shape (n,).
        """
        sums = np.array([along(self.groups == group) for group in range(self.count)])
        data = sums[self.groups[self.columns], self.indices]
        return sp.csc_array((data, self.indices, self.indptr), shape=(self.n, self.n))


ALWAYS = 300  # up to so many unknowns an operator is always written out: it costs no more products than GMRES without preconditioner
AT_MOST = 2000  # above so many unknowns it is never written out
SHARE = 4  # in between it is written out if GMRES needs more products than 1/SHARE of the unknowns
CHUNK = 100  # columns that are written out as a dense array at a time


def worth_it(operator: Operator, n: int) -> bool:
    """Whether writing out a matrix by n products is less work than GMRES without a preconditioner, judged by one solution."""
    if n <= ALWAYS or n > AT_MOST:
        return n <= ALWAYS
    with np.errstate(all="ignore"):
        side = np.random.default_rng(3).standard_normal(n)
        _, missed = gmres(operator, side, rtol=LINEAR.eigenvalues, atol=0.0, restart=n // SHARE, maxiter=1)
    return missed != 0


def written_out(operator: Operator, n: int) -> csc_array:
    """Return the sparse matrix of an operator, from its products with unit vectors."""
    parts, unit = [], np.zeros(n)
    for first in range(0, n, CHUNK):
        columns = np.empty((n, min(CHUNK, n - first)))
        for j in range(columns.shape[1]):
            unit[first + j] = 1.0
            columns[:, j] = np.ravel(operator @ unit)
            unit[first + j] = 0.0
        parts.append(csc_array(columns))
    return csc_array(hstack(parts))
