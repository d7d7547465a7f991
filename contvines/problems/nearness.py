"""How near a problem with many unknowns is to a branch point, where computing all its eigenvalues would be dear.

At every point of a branch there is a cheap number, the distance: with M = [[F_u, F_p], [border]] and a fixed random b it is 1/|M^-1 b|, which falls
to zero like the smallest singular value of M, linearly, at branch points and not at folds (rows hold it with a minus: nothing is past zero). Where it could have been zero between
two points though the sign of det M is the same (:meth:`contvines.bifurcation.detect.Detector.look`), the problem is looked at closely: its
rows then hold the NEAREST eigenvalues to zero of F_u relative to its value at the start.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigs

from .spectra import without_roundoff

NEAREST = 4  # as many null vectors as a branch point may have
ACCURATE = 1e-8  # of eigenvalues by ARPACK


def side(rows: np.ndarray) -> np.ndarray:
    """The fixed right-hand side b, in units of the equations, and zero for the border."""
    return np.append(rows * np.random.default_rng(11).standard_normal(len(rows)), 0.0)


def distance(image: np.ndarray) -> float:
    """1/|M^-1 b|, with M^-1 b in units of unknowns and parameter."""
    square = float(image.dot(image))
    return math.sqrt(len(image) / square) if 0.0 < square < math.inf else 0.0


def nearest(values: np.ndarray) -> np.ndarray:
    """The NEAREST eigenvalues to zero, a pair never torn apart."""
    order = np.argsort(np.abs(values), kind="stable")
    return values[order][:NEAREST]


def nearest_sparse(factors: Any, reference: Any) -> np.ndarray:
    """The NEAREST eigenvalues to zero of reference^-1 F_u, from factors of F_u: the inverses of the largest of F_u^-1 reference.

    Parameters
    ----------
    factors
        Of F_u; None where that is singular.
    reference : sparse matrix
    """
    n = reference.shape[0]
    if factors is None:
        return np.zeros(NEAREST, dtype=complex)
    operator = LinearOperator((n, n), matvec=lambda x: factors.solve(reference @ x), dtype=float)  # type: ignore[call-arg]
    start = np.random.default_rng(5).standard_normal(n)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            options: dict[str, Any] = {"v0": start, "tol": ACCURATE, "return_eigenvectors": False}
            found = eigs(operator, k=NEAREST, **options)
        except ArpackNoConvergence as error:
            found = np.asarray(error.eigenvalues)
        except ArpackError:
            found = np.zeros(0)
        values = without_roundoff(1.0 / np.asarray(found, dtype=complex))
    if not len(values):
        return np.full(NEAREST, np.nan, dtype=complex)
    values = values[np.argsort(np.abs(values), kind="stable")][:NEAREST]
    return np.append(values, np.full(NEAREST - len(values), values[-1]))
