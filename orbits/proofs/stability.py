"""Stability from an enclosure A of the product of the linearised maps (of half the period for a symmetric orbit).

In any norm and for any power k, |A^k| < 1 proves that every multiplier lies inside the unit circle; and |trace A^k| > n (the size
of A) proves that one lies outside, the trace being the sum of n powers. Powers are squared up until one of the two holds.
No eigenvalue is computed, so neither multiple nor vanishing multipliers need care.

The matrices of a long word or of a wide parameter ball are multiplied in moving frames: each factor is seen from frames that the
approximate product carries along, in which it is nearly diagonal, so that errors neither turn nor mix (the QR idea of Lohner).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from orbits.proofs.balls import library
from orbits.proofs.equations import System
from orbits.proofs.obstacles import Obstacle, Remedy, Step

SQUARINGS = 26
LARGE = 1e12


def stable(system: System, nodes: Sequence[Sequence[Any]]) -> tuple[bool | None, Obstacle | None]:
    """True: all multipliers proved inside the unit circle; False: one proved outside; None, and why: neither.

    The trivial multiplier of an impact-free motion, which may be shifted as a whole, is left out.
    """
    motif = system.motif
    if motif.impact_free and not motif.half:
        return None, Obstacle(Step.STABILITY, Remedy.SYMMETRIC)
    try:
        factors = factor_matrices(system, nodes)
        product = _in_frames(factors)
    except ZeroDivisionError:
        return None, Obstacle(Step.STABILITY, Remedy.BORDER, detail="a map has no derivative")
    verdict = _verdict(product)
    return verdict, None if verdict is not None else Obstacle(Step.STABILITY, Remedy.CIRCLE)


def _verdict(product: Any) -> bool | None:
    """By norm and trace of the powers."""
    size = product.nrows()
    for _ in range(SQUARINGS):
        if norm(product) < 1:
            return True
        if abs(product.trace()) > size:
            return False
        product = product * product
    return None


def factor_matrices(system: System, nodes: Sequence[Sequence[Any]]) -> list[Any]:
    """The linearised maps -D_i^{-1} A_i, reduced by the free shift of impact-free motions."""
    arb_mat = library().arb_mat
    blocks = system.linearise(nodes, [])
    factors = [-(arb_mat(D).solve(arb_mat(A))) for A, D in zip(blocks.A, blocks.D)]
    if system.motif.impact_free:
        factors = [_without_shift(factor, system.p) for factor in factors]
    return factors


def _without_shift(factor: Any, p: Any) -> Any:
    """The map of what is left when w (and v + eps w kept) may be shifted: w's row and column fall away."""
    rows = factor.tolist()
    if len(rows) == 4:
        # with v + eps w = (1 + eps) q1 in v's place the shift is along w alone
        eps = p["mass_ratio"]
        rows[2] = [a + eps * b for a, b in zip(rows[2], rows[1])]
        for row in rows:
            row[1] = row[1] - eps * row[2]
    keep = [j for j in range(len(rows)) if j != 1]
    return library().arb_mat([[rows[i][j] for j in keep] for i in keep])


def stable_in_basis(system: System, nodes: Sequence[Sequence[Any]]) -> tuple[bool | None, list[list[str]]]:
    """The same for pieces of branches, with the basis (rows of decimals) in which a checker sees it from the plain product.

    The basis is empty where none helps, or where an impact-free motion's trivial multiplier is in the way.
    """
    if system.motif.impact_free:
        return stable(system, nodes)[0], []
    try:
        factors = factor_matrices(system, nodes)
        product = factors[0].mid()
        for factor in factors[1:]:
            product = (factor.mid() * product).mid()
        basis = _basis(product)
        carried = factors[0] if basis is None else factors[0] * basis
        for factor in factors[1:]:
            carried = factor * carried
        verdict = _verdict(carried if basis is None else basis.solve(carried))
    except ZeroDivisionError:
        return None, []
    return verdict, [] if basis is None else [[repr(float(value)) for value in row] for row in basis.tolist()]


def norm(matrix: Any) -> Any:
    """An upper bound of the largest row sum."""
    zero = library().arb(0)
    rows: list[Any] = [sum((abs(value) for value in row), start=zero) for row in matrix.tolist()]
    return max(row.upper() for row in rows)


def _in_frames(factors: list[Any]) -> Any:
    """A matrix similar to the product of the factors, the first of which acts first."""
    plain = factors[0]
    for factor in factors[1:]:
        plain = factor * plain
    frame = _basis(plain)
    if frame is None:
        return plain
    first, result = frame, None
    for i, factor in enumerate(factors):
        carried = factor * frame
        following = first if i + 1 == len(factors) else _columns(carried)
        if following is None:
            return first.solve(plain * first)
        part = following.solve(carried)
        result = part if result is None else part * result
        frame = following
    return result


def _basis(product: Any) -> Any:
    """Exact columns near a basis of eigenvectors (real and imaginary parts of complex ones), None if there is none."""
    numbers = np.array([[float(value.mid()) for value in row] for row in product.tolist()])
    if not np.all(np.isfinite(numbers)) or np.max(np.abs(numbers), initial=0.0) > 1e280:
        return None
    values, vectors = np.linalg.eig(numbers)
    columns = []
    for value, vector in zip(values, vectors.T):
        if value.imag == 0.0:
            columns.append(vector.real)
        elif value.imag > 0.0:
            columns += [vector.real, vector.imag]
    basis = np.array(columns).T
    return _exact(basis)


def _columns(carried: Any) -> Any:
    """The carried frame's middle with columns of length one, made exact; None if it degenerates."""
    numbers = np.array([[float(value.mid()) for value in row] for row in carried.tolist()])
    lengths = np.linalg.norm(numbers, axis=0)
    if not np.all(lengths > 0.0) or not np.all(np.isfinite(lengths)):
        return None
    return _exact(numbers / lengths)


def _exact(basis: np.ndarray) -> Any:
    if basis.shape[0] != basis.shape[1] or not np.all(np.isfinite(basis)) or np.linalg.cond(basis) > LARGE:
        return None
    return library().arb_mat(basis.tolist())
