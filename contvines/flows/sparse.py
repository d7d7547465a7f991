"""Cycles of large flows with a sparse Jacobian: one factorisation of the whole bordered system, and leading multipliers by ARPACK.

A point costs about as much as the factorisation of a matrix with N m d rows; no dense matrix with d^2 entries is computed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigs, splu

from contvines.shared.numbers import ROUNDED

from ..problems.large.jacobians import Colouring
from ..problems.large.sparse_factors import SuperLUFactors
from ..problems.settings import LINEAR

if TYPE_CHECKING:
    from collections.abc import Callable

    from .mesh import Rule

LARGE = 30  # states from which on the sparsity of the Jacobian is determined
DENSE = 0.25  # part of nonzero entries above which a Jacobian counts as dense
LEADING = 10  # number of multipliers that are computed
# factor of the border rows: small rows become the last pivots, so that the factors stay sparse
SMALL = ROUNDED**0.5


def found_sparsity(jacobian: Callable[[np.ndarray], np.ndarray], places: np.ndarray) -> Colouring | None:
    """Return the sparsity pattern of a Jacobian at some points, with groups of columns; None if it is dense.

    Parameters
    ----------
    jacobian : callable
        x (d,) -> array or sparse matrix (d, d).
    places : ndarray, shape (k, d)
    """
    d = places.shape[1]
    pattern = sp.identity(d, format="csc")
    for x in places:
        value = jacobian(x)
        pattern = pattern + abs(sp.csc_array(value)).astype(bool).astype(float)
    if pattern.nnz > DENSE * d * d:
        return None
    return Colouring(sp.csc_array(pattern), d)


class SparseEquations:
    """Sparsity pattern of the derivatives of a mesh's collocation equations.

    Parameters
    ----------
    pattern : Colouring
        Pattern of df/dx.
    rule : Rule
    count : int
        Number of intervals.
    """

    def __init__(self, pattern: Colouring, rule: Rule, count: int) -> None:
        m, d = rule.degree, pattern.n
        self.rule, self.count, self.node, self.pattern = rule, count, d, pattern
        self.states = count * m * d
        interval, point, node = np.ix_(np.arange(count), np.arange(m), np.arange(m + 1))
        block_row, block_column = (interval * m + point) * d + 0 * node, (interval * m + node) * d + 0 * point
        rows = [
            (block_row[..., None] + pattern.indices).reshape(-1),
            (block_row[..., None] + np.arange(d)).reshape(-1),
        ]
        columns = [
            (block_column[..., None] + pattern.columns).reshape(-1),
            (block_column[..., None] + np.arange(d)).reshape(-1),
        ]
        self.rows, self.columns = np.concatenate(rows), np.concatenate(columns)

    def entries(self, steps: np.ndarray, jacobian: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """Return the entries of the derivatives from those of df/dx at the Gauss points, shape (N m, entries)."""
        m = self.rule.degree
        ratio = scale[self.pattern.columns] / scale[self.pattern.indices]
        scaled = (jacobian * ratio).reshape(self.count, m, 1, -1)
        one = -steps[:, None, None, None] * self.rule.values[None, :, :, None] * scaled
        two = np.broadcast_to(self.rule.slopes[None, :, :, None], (self.count, m, m + 1, self.node))
        return np.concatenate([one.reshape(-1), two.reshape(-1)])

    def closed(self, entries: np.ndarray, closure: float) -> sp.csc_array:
        """Return the derivatives by the values at the nodes, with the last node replaced by `closure` times the first one."""
        last = self.columns >= self.states
        columns = np.where(last, self.columns - self.states, self.columns)
        values = np.where(last, closure * entries, entries)
        return sp.csc_array((values, (self.rows, columns)), shape=(self.states, self.states))

    def opened(self, entries: np.ndarray) -> tuple[sp.csc_array, sp.csc_array]:
        """Return the derivatives by the values at the first node, and by those at all others, without closure."""
        first = self.columns < self.node
        start = sp.csc_array(
            (entries[first], (self.rows[first], self.columns[first])), shape=(self.states, self.node)
        )
        rest = sp.csc_array(
            (entries[~first], (self.rows[~first], self.columns[~first] - self.node)),
            shape=(self.states, self.states),
        )
        return start, rest


def solve_bordered(
    matrix: sp.csc_array, columns: np.ndarray, rows: np.ndarray, corner: np.ndarray, sides: np.ndarray
) -> tuple[np.ndarray, float]:
    """Solve [[matrix, columns], [rows, corner]] x = sides; return solutions and the sign of the determinant.

    Parameters
    ----------
    matrix : sparse, (n, n)
    columns, rows, corner : ndarray, shapes (n, k), (k, n), (k, k)
    sides : ndarray, shape (n + k, s)
    """
    n = len(columns)
    sides = sides.copy()
    sides[n:] *= SMALL
    bordered = sp.block_array([[matrix, columns], [SMALL * rows, SMALL * corner]], format="csc")
    top = float(np.abs(matrix.data).max(initial=1.0))
    for shift in (0.0, ROUNDED * top):
        shifted = bordered + shift * sp.identity(len(sides), format="csc") if shift else bordered
        try:
            factors = SuperLUFactors(sp.csc_array(shifted), "COLAMD")
        except RuntimeError:
            continue
        x = factors.solve(sides)
        more = factors.solve(sides - bordered @ x)
        return (x + more if np.isfinite(more).all() else x), (0.0 if shift else factors.sign)
    return np.full(sides.shape, np.nan), 0.0


def leading_multipliers(
    equations: SparseEquations, entries: np.ndarray, speed: np.ndarray | None
) -> tuple[np.ndarray, float]:
    """Return the largest multipliers, and the distance of the computed trivial multiplier from 1.

    If the velocity at the first node, `speed`, is given (autonomous flows), the trivial multiplier is removed.

    Raises
    ------
    LinAlgError
        If the multipliers do not converge.
    """
    d, count = equations.node, min(LEADING, equations.node - (0 if speed is None else 1))
    start, rest = equations.opened(entries)
    try:
        factors = splu(rest)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error

    def round_once(v: np.ndarray) -> np.ndarray:
        return -factors.solve(start @ v)[-d:]

    missed, along = 0.0, np.zeros(d)
    if speed is not None and (size := float(np.linalg.norm(speed))) > 0.0:
        along = speed / size
        missed = float(np.linalg.norm(round_once(along) - along))

    def return_map(v: np.ndarray) -> np.ndarray:
        v = np.ravel(v)
        image = round_once(v - along * (along @ v))
        return image - along * (along @ image)

    if count >= d - 1:
        values = np.linalg.eigvals(np.column_stack([return_map(v) for v in np.eye(d)]))
    else:
        operator = LinearOperator((d, d), matvec=return_map, dtype=float)  # type: ignore[call-arg]
        v0 = np.random.default_rng(7).standard_normal(d)
        try:
            options: dict[str, Any] = {
                "k": count,
                "v0": v0,
                "tol": LINEAR.iterated,
                "return_eigenvectors": False,
            }
            values = eigs(operator, **options)
        except ArpackNoConvergence as error:
            values = error.eigenvalues
        except ArpackError as error:
            raise np.linalg.LinAlgError(str(error)) from error
    values = np.asarray(values, dtype=complex)
    values = values[np.argsort(-np.abs(values), kind="stable")][:count]
    return np.append(values, np.zeros(count - len(values))), missed


def distance_to_rest(pattern: Colouring, jacobian: np.ndarray, rates: np.ndarray, scale: np.ndarray) -> float:
    """Return the length, in units of the scale, of the Newton step to an equilibrium from the slowest of n points with Jacobians (n, entries) and rates (n, d)."""
    slow = int(np.argmin(((rates / scale) ** 2).sum(axis=1)))
    matrix = sp.csc_array((jacobian[slow], (pattern.indices, pattern.columns)), shape=(pattern.n, pattern.n))
    try:
        step = splu(matrix).solve(rates[slow])
    except RuntimeError:
        return np.inf
    return float(np.linalg.norm(step / scale))
