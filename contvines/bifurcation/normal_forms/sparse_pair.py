"""First Lyapunov coefficient of equations with a sparse Jacobian, from sparse solves and derivatives along lines.

With A q = i omega q and w A = i omega w, B and C the second and third derivatives,

    c = w.[C(q, q, q*) + 2 B(q, h11) + B(q*, h20)] / (2 w.q),   A h11 = -B(q, q*),  (A - 2 i omega) h20 = -B(q, q);   l1 = Re c / omega

as in :mod:`.coefficients`. Source: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., section 5.4, (5.34). The derivatives are
taken from F_u at Chebyshev nodes on the lines along the real and the imaginary part of q; only its products with vectors are stored.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ...problems.large.sparse import SparseWork
from ...shared.numbers import ROUNDED
from ..locate import chebyshev_nodes
from ..settings import NORMAL_FORMS
from .coefficients import Coefficient, in_phase
from .taylor import NODES, RADIUS, SMALLER, taylor_weights

if TYPE_CHECKING:
    from ...problems.protocol import Problem

RADII = 14  # largest number of radii
WORSE = 8.0  # ratio of the change between radii to the least one from which rounding dominates
SWEEPS = 12  # largest number of inverse iterations

Solve = Callable[[np.ndarray], np.ndarray]
Products = Callable[[np.ndarray, np.ndarray], "np.ndarray | None"]


def sparse_lyapunov(problem: Problem, u: np.ndarray, p: float, critical: complex) -> Coefficient:
    """Compute l1 at a Hopf point of equations whose F_u is sparse.

    Parameters
    ----------
    problem : Problem
        A flow with sparse kernels.
    u, p
        The Hopf point.
    critical : complex
        The critical eigenvalue with positive imaginary part, in the user's unit of time.

    Raises
    ------
    ValueError
        If the equations cannot be evaluated near the point, or F_u cannot be factorised; the message gives the reason.
    """
    scales = problem.scales
    units = np.ones(len(u)) if scales is None else np.asarray(scales.unknowns, dtype=float)
    rate = 1.0 if scales is None else float(scales.rate)
    work, data = problem.workspace(), problem.data

    def jacobian(v: np.ndarray) -> sp.csc_array | None:
        evaluated = math.isfinite(problem.kernels.linearise(data, v * units, p, work))
        assert isinstance(work, SparseWork)
        return work.matrix if evaluated else None

    point = u / units
    base = jacobian(point)
    if base is None:
        raise ValueError("the equations cannot be evaluated here")
    base = base.copy()

    def changes(v: np.ndarray, vectors: np.ndarray) -> np.ndarray | None:
        """Return (F_u(v) - F_u(point)) times vectors; the difference of the matrices removes large constant entries before they add rounding."""
        shifted = jacobian(v)
        return (
            None
            if shifted is None
            else ((shifted - base) @ (units[:, None] * vectors)) / (rate * units)[:, None]
        )

    matrix = (sp.diags_array(1.0 / (rate * units)) @ base @ sp.diags_array(units)).tocsc()
    value, q, w = _null(matrix, critical / rate, len(u))
    q = in_phase(q / problem.amplitude(q * units))
    omega = value.imag
    solve = _factors(matrix), _factors(matrix - 2j * omega * sp.eye_array(len(u)))
    reach = max(float(np.sqrt(np.mean(point**2))), 1.0)
    return _coefficient(changes, point, (q, w), omega, solve, reach)


def _coefficient(
    changes: Products,
    u: np.ndarray,
    pair: tuple[np.ndarray, np.ndarray],
    omega: float,
    solve: tuple[Solve, Solve],
    reach: float,
) -> Coefficient:
    """Return l1 from the radius of samples with the least change to the next radius; this change is its error."""
    q, w = pair
    radius = RADIUS * reach / float(np.abs(q).max())
    best, before = Coefficient(np.nan, np.inf), None
    for _ in range(RADII):
        current = _at_radius(changes, u, q, w, solve, radius)
        if current is not None and before is not None:
            change = abs(current - before) / omega
            if change < best.error:
                best = Coefficient(before / omega, change)
            elif change > WORSE * best.error:
                break
            if change <= NORMAL_FORMS.enough * abs(best.value):
                break
        before, radius = current, SMALLER * radius
    if not np.isfinite(best.error):
        raise ValueError("the equations cannot be evaluated near the point")
    return best


def _at_radius(
    changes: Products, u: np.ndarray, q: np.ndarray, w: np.ndarray, solve: tuple[Solve, Solve], radius: float
) -> float | None:
    """Return Re c from samples up to a radius; None if the equations cannot be evaluated there."""
    parts = np.column_stack([np.real(q), np.imag(q)])
    a, b = (_derivatives(changes, u, part, parts, radius) for part in parts.T)
    if a is None or b is None:
        return None
    (along_a, twice_a), (along_b, twice_b) = a, b
    mixed = along_a[:, 0] + along_b[:, 1]  # B(q, q*)
    square = along_a[:, 0] - along_b[:, 1] + 1j * (along_a[:, 1] + along_b[:, 0])  # B(q, q)
    total = twice_a @ [1.0, 1j] + twice_b @ [1.0, 1j]  # C(q, q, q*)
    h11, h20 = np.real(solve[0](-mixed)), solve[1](-square)
    bent = np.column_stack([h11, np.real(h20), np.imag(h20)])
    a, b = (_derivatives(changes, u, part, bent, radius) for part in parts.T)
    if a is None or b is None:
        return None
    (along_a, _), (along_b, _) = a, b
    total = total + 2.0 * (along_a[:, 0] + 1j * along_b[:, 0])
    total = total + (along_a - 1j * along_b)[:, 1:] @ [1.0, 1j]
    return float(np.real(0.5 * (w @ total) / (w @ q)))


def _derivatives(
    changes: Products, u: np.ndarray, x: np.ndarray, vectors: np.ndarray, radius: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return B(x, v) and C(x, x, v) for the columns v of `vectors`, as columns; None if the equations cannot be evaluated."""
    first, second = taylor_weights(NODES, 1), 2.0 * taylor_weights(NODES, 2)
    one, two = np.zeros_like(vectors), np.zeros_like(vectors)
    for t, a, b in zip(chebyshev_nodes(NODES), first, second, strict=True):
        sample = changes(u + radius * t * x, vectors)
        if sample is None:
            return None
        one += a * sample
        two += b * sample
    return one / radius, two / radius**2


def _factors(matrix: sp.csc_array) -> Solve:
    """Return a function that solves with a sparse matrix, for real or complex right-hand sides."""
    try:
        factors = splu(matrix.tocsc().astype(complex))
    except RuntimeError as error:
        raise ValueError("F_u is singular, at zero or at twice the frequency") from error
    return lambda side: factors.solve(np.asarray(side, dtype=complex))


def _null(matrix: sp.csc_array, value: complex, n: int) -> tuple[complex, np.ndarray, np.ndarray]:
    """Return the eigenvalue near `value`, its right and its left eigenvector, by inverse iteration."""
    size, one = float(abs(matrix).max()), sp.eye_array(n)
    for offset in (0.0, ROUNDED * size * (1.0 + 0.3j)):
        try:
            factors = splu((matrix - (value + offset) * one).tocsc().astype(complex))
            break
        except RuntimeError:
            continue
    else:
        raise ValueError("F_u has no factors at the critical eigenvalue")
    found = []
    for transposed, product in (("N", matrix), ("T", matrix.T)):
        vector, residual = np.random.default_rng(6).standard_normal(n).astype(complex), np.inf
        for _ in range(SWEEPS):
            vector = factors.solve(vector, transposed)
            vector = vector / np.linalg.norm(vector)
            image = product @ vector
            current = float(np.linalg.norm(image - (vector.conj() @ image) * vector))
            if not current < 0.5 * residual:
                break
            residual = current
        if not np.isfinite(vector).all():
            raise ValueError("F_u has no eigenvector at the critical eigenvalue")
        found.append(vector)
    right, left = found
    return complex((left @ (matrix @ right)) / (left @ right)), right, left
