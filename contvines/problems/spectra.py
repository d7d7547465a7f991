"""Raw spectra of problems made of Python callables, and how near those with many unknowns are to a branch point.

Computing all eigenvalues would be dear there. At every point of a branch there is a cheap number, the distance: with M = [[F_u, F_p], [border]]
and a fixed random b it is 1/|M^-1 b|, which falls to zero like the smallest singular value of M, linearly, at branch points and not at folds
(rows hold it with a minus: nothing is past zero). Where it could have been zero between two points though the sign of det M is the same
(:meth:`contvines.bifurcation.detect.Detector.look`), another copy of the problem is asked (`closer`): its rows hold the NEAREST eigenvalues to zero
of F_u relative to its value at the start.
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


WATCHED = 20  # unknowns up to which the eigenvalues of problems without a spectrum are all watched for branch points
LARGEST = 300  # unknowns up to which a dense matrix of a sparse Jacobian is made for normal forms
NEAREST = 4  # as many null vectors as a branch point may have


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


def reference_of(jacobian: np.ndarray, rows: np.ndarray, unknowns: np.ndarray) -> np.ndarray:
    """The inverse of a Jacobian, or where it is nearly singular what brings its rows and columns to one size."""
    scaled = jacobian * unknowns / rows[:, None]
    if np.linalg.cond(scaled) < LINEAR.conditioned:
        return np.linalg.inv(jacobian)
    return np.diag(unknowns / rows)


def side(rows: np.ndarray) -> np.ndarray:
    """The fixed right-hand side b, in units of the equations, and zero for the border."""
    return np.append(rows * np.random.default_rng(11).standard_normal(len(rows)), 0.0)


def distance(image: np.ndarray) -> float:
    """1/|M^-1 b|, with M^-1 b in units of unknowns and parameter."""
    square = float(image.dot(image))
    return math.sqrt(len(image) / square) if 0.0 < square < math.inf else 0.0


def is_large(problem: Problem) -> bool:
    """Whether F_u is sparse and no dense matrix of it is made."""
    functions = getattr(problem, "functions", None)
    return getattr(functions, "structure", "dense") == "sparse" and problem.dimension > LARGEST
