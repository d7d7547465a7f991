"""Coefficients of normal forms at a special point, from derivatives of the equations there.

On the critical directions a cycle (or half of it, closed by the mirror) is a map z -> m z + ..., an equilibrium a flow z' = l z + ....

The closure of a cycle's equations says that the last point maps to the first. J(m) is the Jacobian whose closure is multiplied by m, K the part
of J that belongs to the closure (-1 for a flow), B and C are the second and third derivatives of the equations, and each argument of B and C is
continued to the next period with its own multiplier. Then

    fold          z + a z^2      a = -w.B(v, v) / (2 w.K v)
    pitchfork     z + a z^3      a = -w.[C(v, v, v) + 3 B(v, h)] / (6 w.K v),      J(1) h = -B(v, v)
    flip          -z + c z^3     the same with J(-1) v = 0
    Neimark-Sacker  m z + c z^2 z*  c = -w.[C(q, q, q*) + 2 B(q, h11) + B(q*, h20)] / (2 w.K q),  m = exp(i theta),
                                 J(1) h11 = -B(q, q*),  J(m^2) h20 = -B(q, q);      d = Re(c / m)
    Hopf          the same with J - i omega;                                        l1 = Re c / omega

The critical vectors have unit length over the unknowns, those of a cycle over its first point, like the textbook's vectors for the return map.
Source: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 5.4 and 8.7; Kuznetsov and Meijer, SIAM J. Sci. Comput. 26 (2005)
1932, for maps; the form for cycles follows from the same expansion of the block-cyclic system.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...problems.abilities import Evaluable, Returning
from ...problems.protocol import Problem, array_of
from ...shared.numbers import TINY
from ..settings import NORMAL_FORMS
from .taylor import Line, along_line


def _size(vector: np.ndarray) -> float:
    """Return the largest absolute entry."""
    return float(np.abs(vector).max())


def in_phase(vector: np.ndarray) -> np.ndarray:
    """Return a complex vector, turned so that its real and imaginary parts are orthogonal."""
    square = np.sum(vector * vector)
    return vector * np.exp(-0.5j * np.angle(square)) if abs(square) > TINY else vector


class Coefficient(NamedTuple):
    """A normal-form coefficient with an estimate of its error; `size` is the sum of the magnitudes of its terms."""

    value: float
    error: float
    size: float = np.inf


class Pair(NamedTuple):
    """Vectors and derivatives of a pair.

    Attributes
    ----------
    vector : ndarray of complex
        Critical vector q, over two periods of a cycle.
    left : ndarray of complex
        Left null vector w.
    a, b : Line
        Derivatives along the real and the imaginary part of the vector.
    h20 : ndarray of complex
        Quadratic coefficient of the centre manifold.
    weight : complex
        w.K q.
    """

    vector: np.ndarray
    left: np.ndarray
    a: Line
    b: Line
    h20: np.ndarray
    weight: complex


class Forms:
    """Normal forms of a problem at one point.

    Parameters
    ----------
    problem : Problem
        Its ``kernels`` must have ``matrix``; for maps its ``offspring`` must give the same cycle over two periods.
    u, p
        The special point.
    rough : bool
        Compute derivatives to a few digits only, to save time.

    Attributes
    ----------
    units : ndarray, shape (N,)
        Units of the unknowns (their typical sizes): arguments and results of `null`, `chain`, `line` and `rest`, J and K are in these units.
    rate : float
        Typical size of an eigenvalue; its inverse is the unit of time.
    J, K : ndarray, shape (N, N)
        Jacobian, and the part of it that belongs to the closure.
    """

    unknown = "the equations cannot be evaluated"

    def __init__(self, problem: Problem, u: np.ndarray, p: float, rough: bool = False) -> None:
        self.rough = rough
        self.problem, self.p, self.n = problem, float(p), len(u)
        self.flow = problem.spectrum != "map"
        scales = problem.scales
        scaled = scales is not None and len(scales.unknowns) == self.n
        self.units = (
            np.asarray(scales.unknowns, dtype=float) if scaled and scales is not None else np.ones(self.n)
        )
        self.rate = float(scales.rate) if scales is not None and self.flow else 1.0
        self._twice = np.tile(self.units, 2)
        self._plain = not scaled and self.rate == 1.0
        self.u = np.array(u, dtype=float) / self.units
        self.reach = max(float(np.sqrt(np.mean(self.u**2))), 1.0)
        self.work = problem.workspace()
        jacobian = self._jacobian(problem, self.work, self.u)
        if jacobian is None:
            raise ValueError("the equations cannot be evaluated here")
        self.J = jacobian
        if self.flow:
            self.K = -np.eye(self.n)
            self.open, self.open_work, self.whole = problem, self.work, self.u
        else:
            jacobian = self.u * self.units
            problem.kernels.linearise(problem.data, jacobian, self.p, self.work)
            kernels = problem.kernels
            assert kernels.flip is not None and kernels.matrix is not None
            kernels.flip(problem.data, self.work, -1.0)
            self.K = 0.5 * (self.J - self._in_units(kernels.matrix(problem.data, self.work)))
            embedding = problem.offspring(
                problem.flip_kind, jacobian, self.p, np.zeros(self.n + 1), -1.0 + 0.0j
            )[0]
            self.open = embedding.problem
            self.open_work = self.open.workspace()
            self.whole = np.array(embedding.u, dtype=float) / self._twice
        self.lines: dict[bytes, Line] = {}
        self._nulls: dict[complex, tuple[np.ndarray, np.ndarray]] = {}

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """Eigenvalues of an equilibrium, in the user's unit of time."""
        return np.asarray(self.rate * np.linalg.eigvals(self.J), dtype=complex)

    def _in_units(self, matrix: np.ndarray) -> np.ndarray:
        """Convert a Jacobian of one or two periods to the units of the unknowns and of time."""
        if self._plain:
            return matrix
        units = self._units_of(matrix.shape[0])
        return matrix * units / (self.rate * units[:, None])

    def _units_of(self, count: int) -> np.ndarray:
        """Return the units of the unknowns of one period, or of two."""
        return self.units if count == self.n else self._twice

    def _jacobian(self, problem: Problem, work: object, u: np.ndarray) -> np.ndarray | None:
        """Return the Jacobian of a problem at u, in units; None if the equations cannot be evaluated."""
        kernels, data = problem.kernels, problem.data
        unknowns = np.ascontiguousarray(u) if self._plain else u * self._units_of(len(u))
        if not math.isfinite(kernels.linearise(data, unknowns, self.p, work)):
            return None
        assert kernels.matrix is not None
        return self._in_units(kernels.matrix(data, work))

    # ------------------------------------------------------------------ perturbations with their own multiplier
    def closed_by(self, factor: complex) -> np.ndarray:
        """Return J with its closure multiplied by a factor (maps), or J - factor (flows)."""
        if self.flow:
            return self.J - factor * np.eye(self.n)
        return self.J + (factor - 1.0) * self.K

    def extended(self, x: np.ndarray, factor: complex) -> np.ndarray:
        """Return a perturbation of one period, followed by itself times its multiplier, in the unknowns of two periods; for flows unchanged."""
        if self.flow:
            return x
        parts = [self._continued(part) for part in (np.real(x), np.imag(x))]
        return np.concatenate([x, factor * (parts[0] + 1j * parts[1] if np.iscomplexobj(x) else parts[0])])

    def _continued(self, x: np.ndarray) -> np.ndarray:
        """Return the second half of a perturbation of two periods that continues with multiplier one."""
        if not x.any():
            return np.zeros(self.n)
        unknowns, tangent = self.u * self.units, np.append(x * self.units, 0.0)
        embedding = self.problem.offspring(self.problem.flip_kind, unknowns, self.p, tangent, -1.0 + 0.0j)[0]
        return np.asarray(embedding.tangent, dtype=float)[self.n : 2 * self.n] / self.units

    def line(self, x: np.ndarray, factor: complex) -> Line:
        """Return the derivatives of one period's rows along a real perturbation with a multiplier.

        Raises
        ------
        ValueError
            If the equations cannot be evaluated near the point.
        """
        return self.line_of(self.extended(x, factor))

    def line_of(self, direction: np.ndarray) -> Line:
        """Return the same for a direction in the unknowns of two periods; results are stored."""
        direction = np.ascontiguousarray(np.real(direction))
        key = direction.tobytes()
        if key not in self.lines:
            found = along_line(self.rows, self.whole, direction, self.reach, self.rough)
            if found is None:
                raise ValueError(f"{self.unknown} near the special point")
            self.lines[key] = found
        return self.lines[key]

    def rows(self, points: np.ndarray) -> np.ndarray | None:
        """Return the Jacobians of one period's rows at points in the unknowns of two periods; None if one cannot be evaluated."""
        found = []
        for u in points:
            jacobian = self._jacobian(self.open, self.open_work, u)
            if jacobian is None:
                return None
            found.append(jacobian[: self.n])
        return np.array(found)

    # ------------------------------------------------------------------ one real critical direction
    def null(self, factor: complex) -> tuple[np.ndarray, np.ndarray]:
        """Return the right null vector of J closed by a multiplier, of unit length by `unit`, and the left one."""
        if factor not in self._nulls:
            left, _, right = np.linalg.svd(self.closed_by(factor))
            self._nulls[factor] = self.unit(right[-1].conj()), left[:, -1].conj()
        return self._nulls[factor]

    def unit(self, vector: np.ndarray) -> np.ndarray:
        """Scale a direction to unit length over the user's unknowns, for a cycle over its first point."""
        return vector / (self.problem.amplitude(vector * self.units) or np.nan)

    def chain(self, factor: float) -> np.ndarray:
        """Return the null vector and the generalised eigenvector of a double multiplier, shape (N, 2)."""
        first = np.real(self.null(factor)[0])
        if first[np.argmax(np.abs(first))] < 0.0:  # fixes the signs of quadratic coefficients
            first = -first
        second = self._solve(self.closed_by(factor), -(self.K @ first))
        return np.column_stack([first, second - (first @ second) / (first @ first) * first])

    def rests(self, points: np.ndarray, following: np.ndarray | None) -> np.ndarray:
        """Return ``rest`` at k displacements, shape (k, N)."""
        after = [None] * len(points) if following is None else following
        return np.array([self.rest(x, y) for x, y in zip(points, after, strict=True)])

    def rest(self, point: np.ndarray, following: np.ndarray | None) -> np.ndarray:
        """Return the residual of one period at displacement `here`, if the next period starts at displacement `following`; F for a flow.

        NaN if the equations cannot be evaluated.
        """
        unknowns = self.whole + (point if following is None else np.append(point, self._carrier @ following))
        unknowns, rows = unknowns * self._units_of(len(unknowns)), self.rate * self.units
        if isinstance(self.open, Evaluable):  # residuals without derivatives
            with np.errstate(all="ignore"):
                try:
                    return np.asarray(self.open.residuals(unknowns, self.p), dtype=float)[: self.n] / rows
                except (ValueError, ArithmeticError):
                    return np.full(self.n, np.nan)
        if not math.isfinite(self.open.kernels.linearise(self.open.data, unknowns, self.p, self.open_work)):
            return np.full(self.n, np.nan)
        return np.array(array_of(self.open_work).reshape(-1)[: self.n]) / rows

    @cached_property
    def _carrier(self) -> np.ndarray:
        """Matrix of `_continued`, shape (N, N)."""
        return np.column_stack([self._continued(unit) for unit in np.eye(self.n)])

    def quadratic(self, along: np.ndarray | None = None) -> Coefficient:
        """Return a at a fold: z + a z^2, or z' = a z^2. Its sign refers to the direction `along`, if one is given."""
        v, w = (np.real(x) for x in self.null(0.0 if self.flow else 1.0))
        if along is not None and v @ (along / self.units) < 0.0:
            v = -v
        line, weight, x = self.line(v, 1.0), float(w @ self.K @ v) or np.nan, self.extended(v, 1.0)
        value = -0.5 * float(w @ line.second @ x) / weight
        # size of the coefficient if B(v, v) pointed along the left null vector; at a cusp B may vanish: the third derivative is added
        size = float(np.linalg.norm(line.second @ x) + NORMAL_FORMS.step * np.linalg.norm(line.third @ x))
        return self._timed(
            value, abs(0.5 * self.n * line.second_error * _size(v) / weight), 0.5 * size / abs(weight)
        )

    def _timed(self, value: float, error: float, size: float) -> Coefficient:
        """Convert a coefficient of a rate of change to the user's unit of time."""
        return Coefficient(self.rate * value, self.rate * error, self.rate * size)

    def cubic(self, factor: float) -> Coefficient:
        """Return the cubic coefficient at a flip (factor -1) or pitchfork (factor 1; for flows 0)."""
        v, w = self.null(factor)
        v, w = np.real(v), np.real(w)
        closure = factor if not self.flow else 1.0
        line, weight = self.line(v, closure), float(w @ self.K @ v) or np.nan
        x = self.extended(v, closure)
        regular = self.closed_by(0.0 if self.flow else 1.0)
        if factor == (0.0 if self.flow else 1.0):  # this matrix is singular: bordered
            bordered = np.block([[regular, w[:, None]], [v[None, :], np.zeros((1, 1))]])
            h = np.linalg.solve(bordered, np.append(-(line.second @ x), 0.0))[:-1]
        else:
            h = self._solve(regular, -(line.second @ x))
        terms = np.array([w @ (line.third @ x), 3.0 * w @ (line.second @ self.extended(h, 1.0))])
        missed = line.third_error * _size(x) + 3.0 * line.second_error * _size(h)
        error = abs(self.n * missed / (6.0 * weight))
        return self._timed(
            -float(terms.sum()) / (6.0 * weight), error, float(np.abs(terms).sum() / abs(6.0 * weight))
        )

    @staticmethod
    def _solve(matrix: np.ndarray, side: np.ndarray) -> np.ndarray:
        """Solve a linear system; if the matrix is singular, for the solution of least length."""
        return np.linalg.lstsq(matrix, side, rcond=NORMAL_FORMS.cutoff)[0]

    # ------------------------------------------------------------------ a pair
    def lyapunov(self, multiplier: complex) -> tuple[Coefficient, complex]:
        """Return (first Lyapunov coefficient, c) of a pair: d = Re(c / m) for maps, l1 = Re(c) / omega for flows.

        Parameters
        ----------
        multiplier : complex
            m near the unit circle (i omega for flows): the raw multiplier of the problem's own period.
        """
        multiplier = 1j * multiplier.imag / self.rate if self.flow else multiplier / abs(multiplier)
        pair = self._pair(multiplier)
        one, first = pair.vector, pair.a.second + 1j * pair.b.second
        mixed = 0.0 if self.flow else 1.0
        h11 = np.linalg.solve(self.closed_by(mixed), -np.real(first @ one.conj()))
        terms = pair.left @ np.column_stack(
            [
                (pair.a.third + pair.b.third) @ one,  # q q q* = (a^2 + b^2) q
                2.0 * first @ self.extended(h11, 1.0),
                first.conj() @ self.extended(pair.h20, multiplier**2),
            ]
        )
        c = complex(-0.5 * terms.sum() / pair.weight)
        size = float(0.5 * np.abs(terms).sum() / abs(pair.weight))
        bent = 2.0 * _size(h11) + _size(pair.h20)
        missed = pair.a.third_error * _size(one) + pair.a.second_error * bent
        error = float(abs(self.n * missed / pair.weight))
        if self.flow:
            omega = abs(multiplier.imag)
            return Coefficient(c.real / omega, error / omega, size / omega), self.rate * c
        return Coefficient(float((c / multiplier).real), error, size), c

    def _pair(self, multiplier: complex) -> Pair:
        """Compute vectors and derivatives of a pair with a multiplier exactly on the circle (the axis)."""
        q, w = self.null(multiplier)
        q = in_phase(q)
        one = self.extended(q, multiplier)
        a, b = self.line_of(np.real(one)), self.line_of(np.imag(one))
        twice = 2.0 * multiplier if self.flow else multiplier**2
        h20 = np.linalg.solve(self.closed_by(twice), -((a.second + 1j * b.second) @ one))
        return Pair(one, w, a, b, h20, complex(w @ self.K @ q))


def forms_at(problem: Problem, u: np.ndarray, p: float) -> Forms:
    """Return the normal forms of a problem at a point; for cycles of flows those of the return map.

    Raises
    ------
    ValueError
        If the equations cannot be evaluated there.
    """
    if isinstance(problem, Returning):
        return ReturnForms(problem, u, p)
    return Forms(problem, u, p)


class ReturnForms(Forms):
    """Normal forms of the return map P of a cycle of a flow, at its fixed point x = 0. The equations are P(x) - x' = 0, with x' the next return.

    Critical vectors have unit length as states.
    """

    unknown = "motions cannot be followed for a period"

    def __init__(self, problem: Problem, u: np.ndarray, p: float) -> None:
        self.problem, self.p, self.rough = problem, float(p), False
        assert isinstance(problem, Returning)
        self.returns = problem.return_map(u, p)
        self.n = self.returns.basis.shape[1]
        self.flow, self.rate, self.reach = False, 1.0, 1.0
        self.units, self.u, self.whole = np.ones(self.n), np.zeros(self.n), np.zeros(self.n)
        matrix = self.returns.varied(np.zeros((1, self.n)))[1][0]
        if not np.isfinite(matrix).all():
            raise ValueError(f"{self.unknown} beside the cycle")
        self.J, self.K = matrix - np.eye(self.n), -np.eye(self.n)
        self.lines: dict[bytes, Line] = {}
        self._nulls: dict[complex, tuple[np.ndarray, np.ndarray]] = {}

    def along(self, direction: np.ndarray) -> np.ndarray:
        """Return a direction of the cycle's unknowns in the coordinates of the section."""
        return self.returns.inverse @ direction[: self.returns.node]

    def spectrum(self) -> NDArray[np.complex128]:
        """Return the multipliers."""
        return np.asarray(np.linalg.eigvals(self.J + np.eye(self.n)), dtype=complex)

    def extended(self, x: np.ndarray, factor: complex) -> np.ndarray:
        return x

    def unit(self, vector: np.ndarray) -> np.ndarray:
        return vector / (np.linalg.norm(self.returns.basis @ vector) or np.nan)

    def rows(self, points: np.ndarray) -> np.ndarray | None:
        found = self.returns.varied(points)[1]
        return found if np.isfinite(found).all() else None

    def rests(self, points: np.ndarray, following: np.ndarray | None) -> np.ndarray:
        assert following is not None
        return self.returns(points) - following
