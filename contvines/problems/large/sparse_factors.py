"""Factors of sparse matrices by SuperLU, or by LAPACK's band routines if the unknowns can be ordered to a narrow band."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.linalg import get_lapack_funcs
from scipy.sparse.csgraph import connected_components, reverse_cuthill_mckee
from scipy.sparse.linalg import splu

NARROW = 48  # most diagonals of a band
FILL = 3.0  # largest ratio of the band's entries to those of SuperLU's factors at which the band is used
BAND_FACTORISE, BAND_SOLVE = get_lapack_funcs(("gbtrf", "gbtrs"), dtype=np.float64)


def parity(order: np.ndarray) -> int:
    """Return 0 for an even permutation, 1 for an odd one."""
    n = len(order)
    graph = sp.csr_matrix((np.ones(n, dtype=np.int8), (np.arange(n), order)), shape=(n, n))
    return (n - connected_components(graph, directed=False)[0]) % 2


class SuperLUFactors:
    """Factors by SuperLU.

    Parameters
    ----------
    matrix : sparse matrix, csc
    ordering : str
        Of the columns; see ``scipy.sparse.linalg.splu``.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """

    # factorisation costs far more than a solution, so that factors are kept for the next Jacobian
    dear = True

    def __init__(self, matrix: sp.csc_array, ordering: str) -> None:
        self.inner = splu(matrix, permc_spec=ordering)
        self.nnz = int(self.inner.nnz)

    def solve(self, sides: np.ndarray) -> np.ndarray:
        """Apply the inverse to one or more columns."""
        return self.inner.solve(sides)

    @cached_property
    def sign(self) -> float:
        """Sign of the determinant; 0 if that is zero."""
        diagonal = self.inner.U.diagonal()
        if not (diagonal != 0.0).all():
            return 0.0
        odd = int(np.count_nonzero(diagonal < 0.0)) + parity(self.inner.perm_r) + parity(self.inner.perm_c)
        return -1.0 if odd % 2 else 1.0


@dataclass
class Band:
    """Positions of the entries of a sparse matrix in LAPACK's banded form.

    Attributes
    ----------
    indices, indptr : ndarray
        Sparsity pattern (csc).
    order : ndarray
        Unknowns and equations in the order of the band.
    below, above : int
        Numbers of diagonals below and above the main one.
    places : (ndarray, ndarray)
        Row and column of each entry in the banded form.
    """

    indices: np.ndarray
    indptr: np.ndarray
    order: np.ndarray
    below: int
    above: int
    places: tuple[np.ndarray, np.ndarray] = field(repr=False, default=(np.zeros(0, int), np.zeros(0, int)))

    @classmethod
    def of(cls, matrix: sp.csc_array) -> Band | None:
        """Return the band of a matrix, in its own order or in that of Cuthill and McKee; None if the band is too wide."""
        n = len(matrix.indptr) - 1
        columns = np.repeat(np.arange(n), np.diff(matrix.indptr))
        rows = matrix.indices
        best = None
        for order in (np.arange(n), None):
            if order is None:
                if best is not None:
                    break
                pattern = sp.csr_matrix((np.ones(len(rows), np.int8), (rows, columns)), shape=(n, n))
                order = np.asarray(reverse_cuthill_mckee(pattern + pattern.T, symmetric_mode=True))
            place = np.empty(n, dtype=np.int64)
            place[order] = np.arange(n)
            i, j = place[rows], place[columns]
            below, above = int((i - j).max(initial=0)), int((j - i).max(initial=0))
            if 2 * below + above + 1 <= NARROW:
                best = cls(rows, matrix.indptr, order, below, above, (below + above + i - j, j))
        return best

    def fits(self, matrix: sp.csc_array) -> bool:
        """Whether a matrix has this sparsity pattern."""
        return np.array_equal(matrix.indptr, self.indptr) and np.array_equal(matrix.indices, self.indices)

    @property
    def entries(self) -> int:
        """Number of entries of the factors."""
        return (2 * self.below + self.above + 1) * len(self.order)


class BandFactors:
    """Factors by LAPACK's gbtrf.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """

    dear = False  # factorisation is cheap; see `SuperLUFactors`

    def __init__(self, matrix: sp.csc_array, band: Band) -> None:
        self.band, self.nnz = band, band.entries
        table = np.zeros((2 * band.below + band.above + 1, len(matrix.indptr) - 1), order="F")
        table[band.places] = matrix.data
        self.table, self.pivots, info = BAND_FACTORISE(table, band.below, band.above, overwrite_ab=1)
        if info != 0:
            raise RuntimeError("the matrix is singular")

    def solve(self, sides: np.ndarray) -> np.ndarray:
        """Apply the inverse to one or more columns."""
        band = self.band
        found, _ = BAND_SOLVE(
            self.table, band.below, band.above, np.asfortranarray(sides[band.order]), self.pivots
        )
        result = np.empty_like(found)
        result[band.order] = found
        return result.reshape(sides.shape)

    @cached_property
    def sign(self) -> float:
        """Sign of the determinant."""
        diagonal = self.table[self.band.below + self.band.above]
        odd = np.count_nonzero(diagonal < 0.0) + np.count_nonzero(self.pivots != np.arange(len(diagonal)))
        return -1.0 if odd % 2 else 1.0


Factors = SuperLUFactors | BandFactors


@dataclass
class Method:
    """Factorisation of one problem's matrices: column ordering or band, chosen at the first matrix."""

    ordering: str = ""
    band: Band | None = None

    def factorise(self, matrix: sp.csc_array) -> Factors:
        """Factorise a matrix (csc).

        Raises
        ------
        RuntimeError
            If the matrix is singular.
        """
        if self.band is not None and self.band.fits(matrix):
            return BandFactors(matrix, self.band)
        if self.ordering:
            return SuperLUFactors(matrix, self.ordering)
        pattern = matrix.copy()
        pattern.data[:] = 1.0
        symmetric = (pattern != pattern.T).nnz == 0
        tries = {
            name: SuperLUFactors(matrix, name)
            for name in (("MMD_AT_PLUS_A", "COLAMD") if symmetric else ("COLAMD",))
        }
        self.ordering = min(tries, key=lambda name: tries[name].nnz)
        best = tries[self.ordering]
        band = Band.of(matrix)
        if band is not None and band.entries <= FILL * best.nnz:
            self.band = band
            return BandFactors(matrix, band)
        return best
