"""The eigenvalues nearest to zero of a large matrix, by ARPACK."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from ..nearness import NEAREST
from ..settings import LINEAR
from ..spectra import without_roundoff

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.sparse import csc_array


class Solving(Protocol):
    """Factors of a matrix, or what solves with it in another way."""

    def solve(self, sides: np.ndarray, /) -> np.ndarray: ...


def by_arpack(solve: Callable[..., Any], matrix: object, n: int, **options: Any) -> np.ndarray:
    """Eigenvalues that `solve`, which is eigs or eigsh, finds from a fixed start: those that converge, none where it fails."""
    start = np.random.default_rng(5).standard_normal(n)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            found = solve(matrix, v0=start, tol=LINEAR.eigenvalues, return_eigenvectors=False, **options)
        except ArpackNoConvergence as error:
            found = error.eigenvalues
        except RuntimeError:
            found = np.zeros(0)
    return np.asarray(found, dtype=complex)


def nearest_sparse(factors: Solving | None, reference: csc_array, n: int) -> np.ndarray:
    """The NEAREST eigenvalues to zero of reference^-1 F_u, from factors of F_u: the inverses of the largest of F_u^-1 reference.

    Parameters
    ----------
    factors
        Of F_u; None where that is singular.
    reference : sparse matrix, shape (n, n)
    n : int
    """
    if factors is None:
        return np.zeros(NEAREST, dtype=complex)
    operator = LinearOperator((n, n), matvec=lambda x: factors.solve(reference @ x), dtype=float)  # type: ignore[call-arg]
    found = by_arpack(eigs, operator, n, k=NEAREST)
    with np.errstate(all="ignore"):
        values = without_roundoff(1.0 / found)
    if not len(values):
        return np.full(NEAREST, np.nan, dtype=complex)
    values = values[np.argsort(np.abs(values), kind="stable")][:NEAREST]
    return np.append(values, np.full(NEAREST - len(values), values[-1]))
