"""Raw spectra of problems made of Python callables, and the distance of problems with many unknowns from a branch point.

For many unknowns, eigenvalues at every point would be expensive. A cheap number is computed instead, the distance: with
M = [[F_u, F_p], [border]] and a fixed random vector b it is 1/|M^-1 b|. Like the smallest singular value of M, it vanishes linearly at branch
points, and not at folds. (Rows of a branch hold minus the distance, so that it reads as a stable eigenvalue.) If it may have vanished between two
points although the sign of det M is the same (:meth:`contvines.bifurcation.detect.Detector.look`), a copy of the problem (`closer`) is used
there: its rows hold the NEAREST eigenvalues to zero of F_u relative to F_u at the start.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import matrix_balance

from .settings import LINEAR

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from .protocol import Problem


# most unknowns of problems without a spectrum whose eigenvalues are all computed for branch points
WATCHED = 20
LARGEST = 300  # most unknowns of a sparse Jacobian that is converted to a dense matrix for normal forms
NEAREST = 4  # eigenvalues next to zero that are computed: the most null vectors of a branch point


def without_roundoff(values: np.ndarray) -> np.ndarray:
    """Set imaginary parts at the level of roundoff to zero: roundoff turns a double real eigenvalue into a complex pair."""
    values = np.asarray(values, dtype=complex)
    tiny = np.abs(np.imag(values)) <= LINEAR.real * np.abs(values).max(initial=0.0)
    return np.where(tiny, np.real(values) + 0.0j, values)


def rounding(matrix: np.ndarray | csc_array, units: np.ndarray) -> float:
    """Estimate how much rounding of the entries of a matrix moves its eigenvalues, if these are well conditioned.

    Half a unit in the last place of the largest row sum of the matrix as it is, in the units of the unknowns or, for an array, balanced
    by LAPACK. All three are similar matrices, so the smallest number counts. Entries of stiff discretised fields (D/h^2) are much larger
    than the eigenvalues near the imaginary axis, which therefore lose digits.
    """
    sizes = abs(matrix)
    sums = [float((sizes @ units / units).max()), float(np.asarray(sizes.sum(axis=1)).max())]
    if isinstance(matrix, np.ndarray):
        balanced = np.asarray(matrix_balance(matrix, permute=False)[0])
        sums.append(float(np.abs(balanced).sum(axis=1).max()))
    return 2.0**-53 * min(sums)


def vectors_of(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return unit eigenvectors as columns, in the order of the given eigenvalues."""
    found, vectors = np.linalg.eig(matrix)
    left, order = list(range(len(found))), []
    for value in values:
        nearest = min(left, key=lambda j: abs(found[j] - value))
        order.append(nearest)
        left.remove(nearest)
    return vectors[:, order]


def reference_of(jacobian: np.ndarray, rows: np.ndarray, unknowns: np.ndarray) -> np.ndarray:
    """Return the inverse of a Jacobian or, if that is nearly singular, a diagonal matrix that scales its rows and columns to one size."""
    scaled = jacobian * unknowns / rows[:, None]
    if np.linalg.cond(scaled) < LINEAR.conditioned:
        return np.linalg.inv(jacobian)
    return np.diag(unknowns / rows)


def side(rows: np.ndarray) -> np.ndarray:
    """Return the fixed right-hand side b, in units of the equations, and zero for the border."""
    return np.append(rows * np.random.default_rng(11).standard_normal(len(rows)), 0.0)


def distance(image: np.ndarray) -> float:
    """Return 1/|M^-1 b|, with M^-1 b in units of unknowns and parameter."""
    square = float(image.dot(image))
    return math.sqrt(len(image) / square) if 0.0 < square < math.inf else 0.0


def is_large(problem: Problem) -> bool:
    """Whether F_u is sparse and too large for a dense matrix."""
    functions = getattr(problem, "functions", None)
    return getattr(functions, "structure", "dense") == "sparse" and problem.dimension > LARGEST
