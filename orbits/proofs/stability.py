"""Prove stability from an enclosure A of the product of the linearised maps (over half the period for a symmetric orbit).

- Stable: |A^k| < 1 for some norm and some power k proves that all multipliers lie inside the unit circle (for the Euclidean norm:
  1 - A'A is positive definite).
- Unstable: det(1 - A), det(1 + A) and the product of all 1 - mu_i mu_j are positive if all multipliers lie inside, so a negative one proves
  that a multiplier lies outside.

No eigenvalue is enclosed, so multiple or zero multipliers need no special treatment.

For a long word or a wide parameter ball the matrices are multiplied in moving frames: each factor is transformed to frames that
follow the approximate product. There it is nearly diagonal, so that errors of different components do not mix (Lohner's QR method).
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

SQUARINGS = 26  # most squarings of A
DIGITS = 60  # digits of eigenvectors in certificates


def stable(system: System, nodes: Nodes) -> tuple[bool | None, Obstacle | None]:
    """Decide the stability of all orbits with nodes in these balls.

    The trivial multiplier 1 of an impact-free motion (the absorber's position may be shifted) is left out.

    Returns
    -------
    bool or None
        True: all multipliers are proved inside the unit circle; False: one is proved outside; None: neither.
    Obstacle or None
        Why the stability is not decided.
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
    """Decide stability by the signs of det(1 - A), det(1 + A) and prod(1 - mu_i mu_j), and by norms of powers of A."""
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
    """Whether the plain product of the maps, which the checker uses, proves with a reserve that no multiplier is 1 or -1."""
    try:
        factors = factor_matrices(system, nodes)
    except ZeroDivisionError:
        return False
    product, size = factors[0], factors[0].nrows()
    for factor in factors[1:]:
        product = factor * product
    one = diagonal(size)
    determinants = [(one - product).det(), (one + product).det()]
    return all(float(det.rad()) < PROVING.rough * abs(float(det.mid())) for det in determinants)


def _definite(matrix: arb_mat) -> bool:
    """Whether a symmetric matrix is proved positive definite: all leading minors are positive (Sylvester)."""
    rows = matrix.tolist()
    return all(library().arb_mat([row[:k] for row in rows[:k]]).det() > 0 for k in range(1, len(rows) + 1))


def _pairs(product: arb_mat) -> arb:
    """Product of 1 - mu_i mu_j over all pairs of multipliers, computed as det(1 - second compound matrix); positive if all multipliers lie inside."""
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
    """Return the linearised maps, for impact-free motions without the direction of the free shift."""
    factors = linear_maps(system, nodes)
    return [_without_shift(factor, system.p) for factor in factors] if system.motif.impact_free else factors


def linear_maps(system: System, nodes: Nodes) -> list[arb_mat]:
    """Return the linearised maps -D_i^{-1} A_i."""
    arb_mat = library().arb_mat
    blocks = system.linearise(nodes, [])
    return [-(arb_mat(D).solve(arb_mat(A))) for A, D in zip(blocks.A, blocks.D)]


def _without_shift(factor: arb_mat, p: Mapping[str, arb]) -> arb_mat:
    """Remove row and column of w, which may be shifted freely with v + eps w constant."""
    rows = factor.tolist()
    if len(rows) == 4:
        # with the unknown v + eps w = (1 + eps) q1 instead of v the shift changes w alone
        eps = p["mass_ratio"]
        rows[2] = [a + eps * b for a, b in zip(rows[2], rows[1])]
        for row in rows:
            row[1] = row[1] - eps * row[2]
    keep = [j for j in range(len(rows)) if j != 1]
    return library().arb_mat([[rows[i][j] for j in keep] for i in keep])


def stable_in_basis(system: System, nodes: Nodes) -> tuple[bool | None, list[list[str]]]:
    """Decide the stability for a tile; return the verdict and a basis (rows of decimals) in which the checker confirms it with the plain product.

    The basis is empty if none was found.
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
    """Return a basis for the checker; it consists of eigenvectors with many digits if a multiplier is very near the unit circle."""
    try:
        product = middle_product(factor_matrices(system, nodes))
    except ZeroDivisionError:
        return []
    bases = _bases(product)
    basis = _eigenvectors(product) or _written(bases[0]) if bases else []
    if basis and system.motif.impact_free:  # insert a unit vector in place of w, for the shift
        basis = [[*row[:1], "0", *row[1:]] for row in basis]
        basis.insert(1, ["0", "1", *("0" for _ in basis[0][2:])])
    return basis


def middle_product(factors: Sequence[arb_mat]) -> arb_mat:
    """Product of the middles of the maps; the first map acts first."""
    product = factors[0].mid()
    for factor in factors[1:]:
        product = (factor.mid() * product).mid()
    return product


def _eigenvectors(product: arb_mat) -> list[list[str]]:
    """Return eigenvectors (real and imaginary parts of complex ones) as columns, at the current precision; empty if no multiplier is near the circle."""
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
    """Return a matrix similar to the product of the factors (the first acts first), computed in moving frames."""
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
    """Return exact bases in which the stability may be proved, the best one first.

    1. Eigenvectors (real and imaginary parts of complex ones).
    2. For a stable matrix A a basis in which A shortens all vectors, from X = 1 + (A/g)' X (A/g) with g between the spectral radius
       and 1 (Stein's equation); it is the first one if the eigenvectors are ill-conditioned.
    """
    numbers = np.array([[float(value.mid()) for value in row] for row in product.tolist()])
    if not np.all(np.isfinite(numbers)) or np.max(np.abs(numbers), initial=0.0) > PROVING.largest:
        return []
    values, vectors = np.linalg.eig(numbers)
    order = np.argsort(-np.abs(values), kind="stable")  # eigenvalues outside the circle come first
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
        except np.linalg.LinAlgError:  # the radius is 1 to rounding
            sizes, axes = np.ones(size), np.eye(size)
        found.append(_exact(axes / np.sqrt(np.maximum(sizes, 1.0))))
        if not (eigen.shape == (size, size) and np.linalg.cond(eigen) < PROVING.mixed):
            found.reverse()
    return [basis for basis in found if basis is not None]


def _columns(carried: arb_mat) -> arb_mat | None:
    """Return the middle of a frame with columns of length one, as an exact matrix; None if it is degenerate."""
    numbers = np.array([[float(value.mid()) for value in row] for row in carried.tolist()])
    lengths = np.linalg.norm(numbers, axis=0)
    if not np.all(lengths > 0.0) or not np.all(np.isfinite(lengths)):
        return None
    return _exact(numbers / lengths)


def _exact(basis: np.ndarray) -> arb_mat | None:
    """Return a basis as an exact matrix; None if it is not square, not finite or nearly singular."""
    if (
        basis.shape[0] != basis.shape[1]
        or not np.all(np.isfinite(basis))
        or np.linalg.cond(basis) > PROVING.singular
    ):
        return None
    return library().arb_mat(basis.tolist())
