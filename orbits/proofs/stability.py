"""Stability from an enclosure A of the product of the linearised maps (of half the period for a symmetric orbit).

In any norm and for any power k, |A^k| < 1 proves that every multiplier lies inside the unit circle (in the Euclidean one: 1 - A'A is
positive definite). A
negative det(1 - A), det(1 + A) or product of all 1 - mu_i mu_j proves that one lies outside, for each is positive if all lie inside.
No eigenvalue is computed, so neither multiple nor vanishing multipliers need care.

The matrices of a long word or of a wide parameter ball are multiplied in moving frames: each factor is seen from frames that the
approximate product carries along, in which it is nearly diagonal, so that errors neither turn nor mix (the QR idea of Lohner).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from orbits.proofs.balls import diagonal, library
from orbits.proofs.equations import System
from orbits.proofs.obstacles import Obstacle, Remedy, Step
from orbits.settings import PROVING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import arb, arb_mat

    from orbits.proofs.elimination import Nodes

SQUARINGS = 26
DIGITS = 60  # of exact eigenvectors


def stable(system: System, nodes: Nodes) -> tuple[bool | None, Obstacle | None]:
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


def _verdict(product: arb_mat, squarings: int = SQUARINGS) -> bool | None:
    """By the signs of det(1 - A), det(1 + A) and prod(1 - mu_i mu_j), and by norms of the powers."""
    size = product.nrows()
    one = diagonal(size)
    if any(matrix.det() < 0 for matrix in (one - product, one + product)) or _pairs(product) < 0:
        return False
    for _ in range(squarings):
        if _definite(one - product.transpose() * product):
            return True
        product = product * product
    return None


def away_from_one(system: System, nodes: Nodes) -> bool:
    """Whether the plain product of the maps, as a checker forms it, shows that no multiplier is 1 or -1, with room to spare."""
    try:
        factors = factor_matrices(system, nodes)
    except ZeroDivisionError:
        return False
    product, size = factors[0], factors[0].nrows()
    for factor in factors[1:]:
        product = factor * product
    one = diagonal(size)
    both = [(one - product).det(), (one + product).det()]
    return all(float(det.rad()) < PROVING.rough * abs(float(det.mid())) for det in both)


def _definite(matrix: arb_mat) -> bool:
    """Whether a symmetric matrix is positive definite: all leading minors are positive (Sylvester)."""
    rows = matrix.tolist()
    return all(library().arb_mat([row[:k] for row in rows[:k]]).det() > 0 for k in range(1, len(rows) + 1))


def _pairs(product: arb_mat) -> arb:
    """The product of 1 - mu_i mu_j over all pairs of multipliers, which is positive if all lie inside: det(1 - second compound)."""
    size = product.nrows()
    pairs = [(i, j) for j in range(size) for i in range(j)]
    minors = [
        [
            int((i, j) == (k, l)) - (product[i, k] * product[j, l] - product[i, l] * product[j, k])
            for k, l in pairs
        ]
        for i, j in pairs
    ]
    return library().arb_mat(minors).det() if pairs else library().arb(1)


def factor_matrices(system: System, nodes: Nodes) -> list[arb_mat]:
    """The linearised maps, reduced by the free shift of impact-free motions."""
    factors = linear_maps(system, nodes)
    return [_without_shift(factor, system.p) for factor in factors] if system.motif.impact_free else factors


def linear_maps(system: System, nodes: Nodes) -> list[arb_mat]:
    """The linearised maps -D_i^{-1} A_i."""
    arb_mat = library().arb_mat
    blocks = system.linearise(nodes, [])
    return [-(arb_mat(D).solve(arb_mat(A))) for A, D in zip(blocks.A, blocks.D)]


def _without_shift(factor: arb_mat, p: Mapping[str, arb]) -> arb_mat:
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


def stable_in_basis(system: System, nodes: Nodes) -> tuple[bool | None, list[list[str]]]:
    """The same for pieces of branches, with the basis (rows of decimals) in which a checker sees it from the plain product.

    The basis is empty where none helps.
    """
    if system.motif.impact_free:
        return stable(system, nodes)[0], basis_texts(system, nodes)
    try:
        factors = factor_matrices(system, nodes)
    except ZeroDivisionError:
        return None, []
    for basis in _bases(middle_product(factors)):
        carried = factors[0] * basis
        for factor in factors[1:]:
            carried = factor * carried
        try:
            verdict = _verdict(basis.solve(carried), 1)
        except ZeroDivisionError:
            continue
        if verdict is not None:
            return verdict, _written(basis)
    return None, []


def basis_texts(system: System, nodes: Nodes) -> list[list[str]]:
    """That basis alone; of eigenvectors with many digits where multipliers hardly lie on one side of the circle."""
    try:
        product = middle_product(factor_matrices(system, nodes))
    except ZeroDivisionError:
        return []
    bases = _bases(product)
    basis = _eigenvectors(product) or _written(bases[0]) if bases else []
    if basis and system.motif.impact_free:  # the direction of the shift, which takes w's place, is left open
        basis = [[*row[:1], "0", *row[1:]] for row in basis]
        basis.insert(1, ["0", "1", *("0" for _ in basis[0][2:])])
    return basis


def middle_product(factors: Sequence[arb_mat]) -> arb_mat:
    """The product of the maps' middles, the first one rightmost."""
    product = factors[0].mid()
    for factor in factors[1:]:
        product = (factor.mid() * product).mid()
    return product


def _eigenvectors(product: arb_mat) -> list[list[str]]:
    """Eigenvectors, real and imaginary parts of complex ones, at the precision in force; empty if none is near the circle."""
    flint = library()
    try:
        values, vectors = flint.acb_mat(product).eig(right=True)
    except ValueError:  # multiple ones
        return []
    if not any(abs(abs(complex(value)) - 1.0) < PROVING.critical for value in values):
        return []
    columns = []
    for j in sorted(range(len(values)), key=lambda j: -abs(complex(values[j]))):
        vector = [vectors[i, j] for i in range(len(values))]
        angle = complex(values[j]).imag
        if abs(angle) < PROVING.real * abs(complex(values[j])):
            columns.append([entry.real for entry in vector])
        elif angle > 0.0:
            columns += [[entry.real for entry in vector], [entry.imag for entry in vector]]
    if len(columns) != len(values):
        return []
    return [[entry.mid().str(DIGITS, radius=False) for entry in row] for row in zip(*columns)]


def _written(basis: arb_mat) -> list[list[str]]:
    return [[repr(float(value)) for value in row] for row in basis.tolist()]


def _in_frames(factors: list[arb_mat]) -> arb_mat:
    """A matrix similar to the product of the factors, the first of which acts first."""
    plain = factors[0]
    for factor in factors[1:]:
        plain = factor * plain
    bases = _bases(plain)
    if not bases:
        return plain
    frame = bases[0]
    first, parts = frame, []
    for i, factor in enumerate(factors):
        carried = factor * frame
        following = first if i + 1 == len(factors) else _columns(carried)
        if following is None:
            return first.solve(plain * first)
        parts.append(following.solve(carried))
        frame = following
    return reduce(lambda product, part: part * product, parts)


def _bases(product: arb_mat) -> list[arb_mat]:
    """Exact bases that may show stability plainly, the better ones first.

    One of eigenvectors, real and imaginary parts of complex ones, where it is well-conditioned; of a stable matrix A one in which it
    shortens all vectors, from X = 1 + (A/g)' X (A/g) with g between the spectral radius and 1 (Lyapunov, Stein).
    """
    numbers = np.array([[float(value.mid()) for value in row] for row in product.tolist()])
    if not np.all(np.isfinite(numbers)) or np.max(np.abs(numbers), initial=0.0) > PROVING.largest:
        return []
    values, vectors = np.linalg.eig(numbers)
    order = np.argsort(-np.abs(values), kind="stable")  # those outside the circle come first
    columns = []
    for value, vector in zip(values[order], vectors.T[order]):
        if value.imag == 0.0:
            columns.append(vector.real)
        elif value.imag > 0.0:
            columns += [vector.real, vector.imag]
    eigen = np.array(columns).T
    found = [_exact(eigen)]
    radius, size = float(np.max(np.abs(values))), len(values)
    if radius < 1.0:
        scaled = numbers / (0.5 + 0.5 * radius)
        stein = np.eye(size * size) - np.kron(scaled.T, scaled.T)
        try:
            X = np.linalg.solve(stein, np.eye(size).ravel()).reshape(size, size)
            sizes, axes = np.linalg.eigh(0.5 * (X + X.T))  # principal axes, so that errors do not mix
        except np.linalg.LinAlgError:  # the radius is 1 but for rounding
            sizes, axes = np.ones(size), np.eye(size)
        found.append(_exact(axes / np.sqrt(np.maximum(sizes, 1.0))))
        if not (eigen.shape == (size, size) and np.linalg.cond(eigen) < PROVING.mixed):
            found.reverse()
    return [basis for basis in found if basis is not None]


def _columns(carried: arb_mat) -> arb_mat | None:
    """The carried frame's middle with columns of length one, made exact; None if it degenerates."""
    numbers = np.array([[float(value.mid()) for value in row] for row in carried.tolist()])
    lengths = np.linalg.norm(numbers, axis=0)
    if not np.all(lengths > 0.0) or not np.all(np.isfinite(lengths)):
        return None
    return _exact(numbers / lengths)


def _exact(basis: np.ndarray) -> arb_mat | None:
    if (
        basis.shape[0] != basis.shape[1]
        or not np.all(np.isfinite(basis))
        or np.linalg.cond(basis) > PROVING.singular
    ):
        return None
    return library().arb_mat(basis.tolist())
