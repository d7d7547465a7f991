"""Raw spectra of problems made of Python callables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import matrix_balance

from .settings import LINEAR

if TYPE_CHECKING:
    from scipy.sparse import csc_array

WATCHED = (
    20  # unknowns up to which the eigenvalues of problems without a spectrum are watched for branch points
)


def without_roundoff(values: np.ndarray) -> np.ndarray:
    """Eigenvalues in which the two halves of a double real one, parted by roundoff, are real."""
    values = np.asarray(values, dtype=complex)
    tiny = np.abs(np.imag(values)) <= LINEAR.real * np.abs(values).max(initial=0.0)
    return np.where(tiny, np.real(values) + 0.0j, values)


def rounding(matrix: np.ndarray | csc_array, units: np.ndarray) -> float:
    """By how much rounding of the entries of a matrix moves its eigenvalues, if these are well conditioned.

    Half a unit in the last place of the largest sum of a row, in the units of the unknowns or as they are, or, of an array, as LAPACK
    balances it: each is a similarity, so the smallest counts. Entries of stiff fields (D/h^2) are much larger than the eigenvalues
    next to the axis, whose digits they take.
    """
    sizes = abs(matrix)
    sums = [float((sizes @ units / units).max()), float(np.asarray(sizes.sum(axis=1)).max())]
    if isinstance(matrix, np.ndarray):
        balanced = np.asarray(matrix_balance(matrix, permute=False)[0])
        sums.append(float(np.abs(balanced).sum(axis=1).max()))
    return 2.0**-53 * min(sums)


def vectors_of(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Unit eigenvectors as columns, in the order of eigenvalues that are known."""
    found, vectors = np.linalg.eig(matrix)
    left, order = list(range(len(found))), []
    for value in values:
        nearest = min(left, key=lambda j: abs(found[j] - value))
        order.append(nearest)
        left.remove(nearest)
    return vectors[:, order]


def watched(jacobian: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Eigenvalues of a Jacobian relative to a fixed one: zero where it is singular, whatever the scale of its rows."""
    return without_roundoff(np.linalg.eigvals(reference @ jacobian))


def reference_of(jacobian: np.ndarray, rows: np.ndarray, unknowns: np.ndarray) -> np.ndarray:
    """The inverse of a Jacobian, or where it is nearly singular what brings its rows and columns to one size."""
    scaled = jacobian * unknowns / rows[:, None]
    if np.linalg.cond(scaled) < LINEAR.conditioned:
        return np.linalg.inv(jacobian)
    return np.diag(unknowns / rows)
