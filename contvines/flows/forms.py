"""Normal forms of the return map of a cycle at folds, period doublings, pitchforks and Neimark-Sacker points.

The equations of one return are the collocation equations at the Gauss points, with the values x_0 ... x_N at the mesh points, where x_N is
the x_0 of the next return, and with the time of return as an unknown; for autonomous flows x_0 lies in a plane across the motion. J(m) is
their Jacobian with x_N = m x_0, K its part that belongs to x_N, and B and C are their second and third derivatives. Then

    fold            z + a z^2        a = -w.B(v, v) / (2 w.K v),                            J(1) v = 0
    m = -1 or 1     m z + c z^3       c = -w.[C(v, v, v) + 3 B(v, h)] / (6 w.K v),      J(m) v = 0,   J(1) h = -B(v, v)
    Neimark-Sacker  m z + c z^2 z*    c = -w.[C(q, q, q*) + 2 B(q, h11) + B(q*, h20)] / (2 w.K q),   J(m) q = 0,
                                      J(1) h11 = -B(q, q*),  J(m^2) h20 = -B(q, q);   d = Re(c / m)

where w is the left null vector of J(m). For m = 1 (symmetry breaking, or a branch point that is a pitchfork) J(1) is singular, w.B(v, v) = 0,
and h is determined up to multiples of v, on which c does not depend. Critical vectors have unit length at x_0. The expansion is that of
Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 5.4 and 8.7, for the return map; Kuznetsov, Govaerts, Doedel and
Dhooge, SIAM J. Numer. Anal. 43 (2005) 1407, use integrals along the cycle instead.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import block_array, csc_array
from scipy.sparse.linalg import splu

from . import mesh
from .field import SIXTH

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

    from .cycle_mesh import CycleMesh

# distance along the critical direction at which third derivatives enter the size of a fold's terms
NEAR = 0.001
LARGEST = 100_000  # most unknowns of one return for which normal forms are computed
STEP = 0.02  # of differences of Jacobians, in lengths over which the right-hand side is nonlinear
# sixth-order second difference: weights of f(x + k h) + f(x - k h) ...
SECOND = ((1, 1.5), (2, -0.15), (3, 1.0 / 90.0))
MIDDLE = -49.0 / 18.0  # ... and of f(x)


class Return:
    """The equations of one return of a cycle.

    Parameters
    ----------
    problem : CycleMesh
    u, p
        A cycle.

    Raises
    ------
    NotEvaluable
        If the right-hand side fails there.
    """

    def __init__(self, problem: CycleMesh, u: np.ndarray, p: float) -> None:
        self.problem, self.p = problem, p
        r, d, m, count = problem.rule, problem.node, problem.rule.degree, problem.intervals
        self.free, self.states = problem.free_period, problem.states
        x, period, widths = problem.parts(u, p)
        self.points = mesh.at_gauss_points(r.values, x)
        self.steps = np.repeat(period * widths, m)
        self.widths = np.repeat(widths, m)
        forced, around = problem.field.forced, (problem.copies, problem.rounds)
        self.times = period / problem.rounds * mesh.phases(widths, r.points, *around) if forced else None
        self.jacobian = problem.field.jacobian(self.points, p, self.times)
        f = problem.field(self.points, p, self.times)
        self.size = self.states + self.free
        blocks = r.blocks(self.steps[:, None, None] * self.jacobian)
        # sparse matrices from rows, columns and values; the part of x_N is a matrix of its own, in the columns of x_0
        rows = np.repeat(np.arange(self.states), (m + 1) * d).reshape(blocks.shape)
        columns = (
            np.broadcast_to(np.arange((m + 1) * d), blocks.shape) + (m * d * np.arange(count))[:, None, None]
        )
        last = columns >= self.states
        inside = [(blocks[~last], rows[~last], columns[~last])]
        shape = (self.size, self.size)
        self.closure = csc_array((blocks[last], (rows[last], columns[last] - self.states)), shape=shape)
        if self.free:
            speed = problem.field(x[:1, 0], p)[0]
            along = -(self.widths[:, None] * f).reshape(-1)
            inside.append((along, np.arange(self.states), np.full(self.states, self.states)))
            inside.append((speed / np.linalg.norm(speed), np.full(d, self.states), np.arange(d)))
        values, i, j = (np.concatenate([np.ravel(part[k]) for part in inside]) for k in range(3))
        self.whole = csc_array((values, (i, j)), shape=shape)

    def closed_by(self, factor: complex) -> csc_array:
        """Return J(m)."""
        return csc_array(self.whole + factor * self.closure)

    def solve(self, factor: complex, side: np.ndarray) -> np.ndarray:
        """Apply J(m)^-1 to a vector."""
        matrix = self.closed_by(factor)
        return splu(matrix).solve(side.astype(matrix.dtype))

    def parts(self, x: np.ndarray, factor: complex) -> tuple[np.ndarray, complex]:
        """Split a perturbation into its values at the Gauss points and the change of the period."""
        problem = self.problem
        ends = mesh.closed(x[: self.states].reshape(problem.intervals, problem.rule.degree, problem.node))
        ends[-1, -1] = factor * x[: problem.node]
        at = np.einsum("cj,ijk->ick", problem.rule.values, ends).reshape(-1, problem.node)
        return at, x[-1] if self.free else 0.0

    def bent(self, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the first and second derivatives of df/dx along a real direction at each Gauss point."""
        field = self.problem.field
        size = float((np.abs(direction) / field.lengths).max()) or 1.0
        step = STEP / size

        def at(k: float) -> np.ndarray:
            return field.jacobian(self.points + k * step * direction, self.p, self.times)

        sides = {k: (at(float(k)), at(float(-k))) for k, _ in SIXTH}
        one = sum(weight * (sides[k][0] - sides[k][1]) for k, weight in SIXTH)
        two = sum(weight * (sides[k][0] + sides[k][1]) for k, weight in SECOND) + MIDDLE * self.jacobian
        return np.asarray(one) / step, np.asarray(two) / step**2

    def rows(self, values: np.ndarray) -> np.ndarray:
        """Extend derivatives of the collocation equations by 0 for the plane's equation, which is linear."""
        flat = np.asarray(values).reshape(-1)
        return np.append(flat, 0.0) if self.free else flat

    def second(
        self, bent: np.ndarray, a: tuple[np.ndarray, complex], b: tuple[np.ndarray, complex]
    ) -> np.ndarray:
        """Return B(a, b) of two perturbations (at the Gauss points, period); `bent` is the derivative of df/dx along a."""
        (x, t), (y, s) = a, b
        value = -self.steps[:, None] * _apply(bent, y)
        value = value - self.widths[:, None] * (t * _apply(self.jacobian, y) + s * _apply(self.jacobian, x))
        return self.rows(value)

    def critical(self, factor: complex) -> Critical:
        """Return the null vectors of J(m), and the factors of J(m) bordered by a random row for x_0 and a random column for the last equations."""
        matrix, d, n = self.closed_by(factor), self.problem.node, self.size
        edges = np.random.default_rng(6).standard_normal((2, n))
        edges[0, : self.states - self.problem.rule.degree * d] = 0.0
        edges[1, d:] = 0.0
        bordered = block_array([[matrix, edges[:1].T], [edges[1:], None]], format="csc", dtype=matrix.dtype)
        factors = splu(bordered)
        side = np.append(np.zeros(n), 1.0).astype(matrix.dtype)
        v, w = factors.solve(side)[:-1], factors.solve(side, trans="T")[:-1]
        v = v / np.linalg.norm(v[:d])
        return Critical(v, w, complex(w @ (self.closure @ v)), factors)


class Critical(NamedTuple):
    """Right null vector v of J(m), of unit length at x_0, left null vector w, ``weight`` w.K v, and the factors of the bordered matrix."""

    right: np.ndarray
    left: np.ndarray
    weight: complex
    bordered: SuperLU


def _apply(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    return np.einsum("nab,nb->na", matrices, vectors)


def quadratic(problem: CycleMesh, u: np.ndarray, p: float, along: np.ndarray) -> tuple[float, float]:
    """Return the coefficient a at a fold, and the sum of the magnitudes of its terms; the sign of v is that of `along`."""
    system = Return(problem, u, p)
    v, w, weight, _ = system.critical(1.0)
    parts = system.parts(v, 1.0)
    one, two = system.bent(parts[0])
    side = system.second(one, parts, parts)
    first, direction = slice(0, problem.node), along[: problem.node]
    if system.free:
        speed = problem.field(u[None, first], p)[0]
        direction = direction - (speed @ direction) / (speed @ speed) * speed
    third = system.rows(system.steps[:, None] * _apply(two, parts[0]))
    size = np.linalg.norm(w) * (np.linalg.norm(side) + NEAR * np.linalg.norm(third))
    scale = math.copysign(0.5, -float(v[first] @ direction)) / np.real(weight)
    return float(scale * (w @ side)), float(abs(scale) * size)


def cubic(problem: CycleMesh, u: np.ndarray, p: float, factor: float) -> tuple[float, float]:
    """Return c at a period doubling (m = -1) or a pitchfork (m = 1), and the sum of the magnitudes of its terms."""
    system = Return(problem, u, p)
    v, w, weight, bordered = system.critical(factor)
    parts = system.parts(v, factor)
    one, two = system.bent(parts[0])
    side = -system.second(one, parts, parts)
    h = system.solve(1.0, side) if factor < 0.0 else bordered.solve(np.append(side, 0.0))[:-1]
    third = -system.steps[:, None] * _apply(two, parts[0]) - 3.0 * system.widths[:, None] * parts[1] * _apply(
        one, parts[0]
    )
    terms = np.array([w @ system.rows(third), 3.0 * w @ system.second(one, parts, system.parts(h, 1.0))])
    return _summed(-terms / (6.0 * np.real(weight)))


def _summed(terms: np.ndarray) -> tuple[float, float]:
    return float(terms.sum()), float(np.abs(terms).sum())


def neimark_sacker(problem: CycleMesh, u: np.ndarray, p: float, multiplier: complex) -> tuple[float, float]:
    """Return d = Re(c / m) at a Neimark-Sacker point, and the sum of the magnitudes of its terms."""
    m = multiplier / abs(multiplier)
    system = Return(problem, u, p)
    q, w, weight, _ = system.critical(m)
    parts = system.parts(q, m)
    other: tuple[np.ndarray, complex] = (parts[0].conj(), np.conj(parts[1]))
    a1, a2 = system.bent(np.real(parts[0]))
    b1, b2 = system.bent(np.imag(parts[0]))
    along, against = a1 + 1j * b1, a1 - 1j * b1
    h11 = system.solve(1.0 + 0j, -system.second(along, parts, other))
    h20 = system.solve(m**2, -system.second(along, parts, parts))
    t, s = parts[1], other[1]
    third = -system.steps[:, None] * _apply(a2 + b2, parts[0]) - system.widths[:, None] * (
        2.0 * t * _apply(along, other[0]) + s * _apply(along, parts[0])
    )
    terms = [
        w @ system.rows(third),
        2.0 * w @ system.second(along, parts, system.parts(h11, 1.0)),
        w @ system.second(against, other, system.parts(h20, m**2)),
    ]
    return _summed(np.real(-0.5 * np.array(terms) / weight / m))
