"""Coefficients of normal forms at a special point, from derivatives of the equations there.

A cycle (or half of it, closed by the mirror) is a map z -> m z + ... on the critical directions; an equilibrium a flow
z' = l z + .... With J(m) the Jacobian whose closure is multiplied by m, K the part of J that belongs to the closure (-1 for a
flow), B and C the second and third derivatives of the equations, whose arguments are closed by their own multipliers,

    fold          z + a z^2      a = -w.B(v, v) / (2 w.K v)
    pitchfork     z + a z^3      a = -w.[C(v, v, v) + 3 B(v, h)] / (6 w.K v),      J(1) h = -B(v, v)
    flip          -z + c z^3     the same with J(-1) v = 0
    Neimark-Sacker  m z + c z^2 z*  c = -w.[C(q, q, q*) + 2 B(q, h11) + B(q*, h20)] / (2 w.K q),  m = exp(i theta),
                                 J(1) h11 = -B(q, q*),  J(m^2) h20 = -B(q, q);      d = Re(c / m)
    Hopf          the same with J - i omega;                                        l1 = Re c / omega

The critical vectors have unit length (of a cycle: over all its unknowns), as in the textbook. Source: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., sections 5.4 and 8.7; Kuznetsov and Meijer,
SIAM J. Sci. Comput. 26 (2005) 1932, for maps; the form for cycles follows from the same expansion of the block-cyclic system.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .taylor import Line, along_line

NEAR = 1e-3  # distance along the critical direction at which the third derivative counts


class Coefficient(NamedTuple):
    """A normal-form coefficient with an estimate of its error."""

    value: float
    error: float


class Pair(NamedTuple):
    """The critical vector of a pair with open ends, the left one, derivatives along real and imaginary part, h20, w.K q."""

    vector: Any
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
        Its ``kernels`` have ``matrix``; for maps ``offspring`` gives the cycle written twice.
    u, p
        The special point.
    rough : bool
        A few digits only, for scanning.
    """

    def __init__(self, problem: Any, u: np.ndarray, p: float, rough: bool = False) -> None:
        self.rough = rough
        self.problem, self.u, self.p = problem, np.array(u, dtype=float), float(p)
        self.n = len(self.u)
        self.work = problem.workspace()
        self.flow = problem.spectrum != "map"
        here = self._jacobian(problem, self.work, self.u)
        if here is None:
            raise ValueError("the equations cannot be evaluated here")
        self.J = here
        if self.flow:
            self.K = -np.eye(self.n)
            self.open, self.open_work, self.whole = problem, self.work, self.u
        else:
            problem.kernels.linearise(problem.data, self.u, self.p, self.work)
            problem.kernels.flip(problem.data, self.work, -1.0)
            self.K = 0.5 * (self.J - problem.kernels.matrix(problem.data, self.work))
            embedding = problem.offspring(
                problem.flip_kind, self.u, self.p, np.zeros(self.n + 1), -1.0 + 0.0j
            )[0]
            self.open = embedding.problem
            self.open_work, self.whole = self.open.workspace(), np.array(embedding.u, dtype=float)
        self.lines: dict[bytes, Line] = {}

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """Of J: those of an equilibrium, in the user's own unit of time."""
        return np.asarray(np.linalg.eigvals(self.J), dtype=complex)

    def _jacobian(self, problem: Any, work: Any, u: np.ndarray) -> np.ndarray | None:
        residual = problem.kernels.linearise(problem.data, np.ascontiguousarray(u), self.p, work)
        if not residual < 1e300:
            return None
        return problem.kernels.matrix(problem.data, work)

    # ------------------------------------------------------------------ open ends
    def closed_by(self, factor: complex) -> np.ndarray:
        """J with its closure multiplied (maps), or J - factor (flows)."""
        if self.flow:
            return self.J - factor * np.eye(self.n)
        return self.J + (factor - 1.0) * self.K

    def extended(self, x: np.ndarray, factor: complex) -> np.ndarray:
        """A perturbation of one period followed by itself times its multiplier, in the unknowns of the doubled cycle."""
        if self.flow:
            return x
        parts = [self._continued(part) for part in (np.real(x), np.imag(x))]
        return np.concatenate([x, factor * (parts[0] + 1j * parts[1] if np.iscomplexobj(x) else parts[0])])

    def _continued(self, x: np.ndarray) -> np.ndarray:
        """What the doubled cycle has in its second half if the perturbation goes on with multiplier one."""
        if not x.any():
            return np.zeros(self.n)
        tangent = np.append(x, 0.0)
        embedding = self.problem.offspring(self.problem.flip_kind, self.u, self.p, tangent, -1.0 + 0.0j)[0]
        return np.asarray(embedding.tangent, dtype=float)[self.n : 2 * self.n]

    def line(self, x: np.ndarray, factor: complex) -> Line:
        """Derivatives of the rows of one period along a real perturbation whose closure is multiplied."""
        return self.line_of(self.extended(x, factor))

    def line_of(self, direction: np.ndarray) -> Line:
        """The same for a direction of the doubled cycle."""
        direction = np.ascontiguousarray(np.real(direction))
        key = direction.tobytes()
        if key not in self.lines:

            def rows(u: np.ndarray) -> np.ndarray | None:
                found = self._jacobian(self.open, self.open_work, u)
                return None if found is None else found[: self.n]

            found = along_line(rows, self.whole, direction, self._reach(direction), self.rough)
            if found is None:
                raise ValueError("the equations cannot be evaluated near the special point")
            self.lines[key] = found
        return self.lines[key]

    def _reach(self, direction: np.ndarray) -> float:
        """Size of the largest entry of a direction where some unknown changes by its typical size."""
        scales = getattr(self.problem, "scales", None)
        if scales is None:
            return max(float(np.sqrt(np.mean(self.u**2))), 1.0)
        parts = np.abs(direction).reshape(-1, self.n)
        shares = float((parts / scales.unknowns).max())
        return float(parts.max()) / shares if shares > 0.0 else 1.0

    # ------------------------------------------------------------------ one real critical direction
    def null(self, factor: complex) -> tuple[np.ndarray, np.ndarray]:
        """Unit right and left null vector of J closed by a multiplier; found with unknowns and rows in units of their scales."""
        scales = getattr(self.problem, "scales", None)
        units, rows = (1.0, 1.0) if scales is None else (scales.unknowns, scales.rows)
        left, _, right = np.linalg.svd(self.closed_by(factor) * units / np.reshape(rows, (-1, 1)))
        v, w = right[-1].conj() * units, left[:, -1].conj() / rows
        return v / np.linalg.norm(v), w / np.linalg.norm(w)

    def quadratic(self, along: np.ndarray | None = None) -> Coefficient:
        """a at a fold: z + a z^2, or z' = a z^2; its sign is that along a direction, if one is given."""
        v, w = (np.real(x) for x in self.null(0.0 if self.flow else 1.0))
        if along is not None and v @ along < 0.0:
            v = -v
        line, weight = self.line(v, 1.0), float(w @ self.K @ v) or np.nan
        value = -0.5 * float(w @ line.second @ self.extended(v, 1.0)) / weight
        return Coefficient(value, abs(0.5 * self.n * line.second_error / weight))

    def size_of_quadratic(self, along: np.ndarray) -> float:
        """What the quadratic coefficient would be if the second derivative pointed along the left null vector.

        At a cusp it may vanish; what the third derivative makes of it a little further along counts, too.
        """
        v, w = (np.real(x) for x in self.null(0.0 if self.flow else 1.0))
        if v @ along < 0.0:
            v = -v
        line, x = self.line(v, 1.0), self.extended(v, 1.0)
        size = float(np.linalg.norm(line.second @ x) + NEAR * np.linalg.norm(line.third @ x))
        return 0.5 * size / (abs(float(w @ self.K @ v)) or np.nan)

    def cubic(self, factor: float) -> Coefficient:
        """The cubic coefficient at a flip (factor -1) or pitchfork (factor 1; flows 0)."""
        v, w = self.null(factor)
        v, w = np.real(v), np.real(w)
        closure = factor if not self.flow else 1.0
        line, weight = self.line(v, closure), float(w @ self.K @ v) or np.nan
        x = self.extended(v, closure)
        regular = self.closed_by(0.0 if self.flow else 1.0)
        h = self._solve(regular, -(line.second @ x))
        total = w @ (line.third @ x) + 3.0 * w @ (line.second @ self.extended(h, 1.0))
        error = abs(self.n * (line.third_error + 3.0 * line.second_error) / (6.0 * weight))
        return Coefficient(-float(total) / (6.0 * weight), error)

    @staticmethod
    def _solve(matrix: np.ndarray, side: np.ndarray) -> np.ndarray:
        """A solution, of least length where the matrix is singular."""
        return np.linalg.lstsq(matrix, side, rcond=1e-10)[0]

    def bogdanov_takens(self) -> tuple[float, float]:
        """(a, b) at a double zero of a flow: z1' = z2, z2' = a z1^2 + b z1 z2.

        Source: Kuznetsov, section 8.4, with q0, q1 and p1, p0 the right and left chains of the double zero.
        """
        q0, p1 = (np.real(x) for x in self.null(0.0))
        if q0[np.argmax(np.abs(q0))] < 0.0:  # a and b change their signs with q0
            q0 = -q0
        q1, p0 = self._solve(self.J, q0), self._solve(self.J.T, p1)
        q1 = q1 - (q0 @ q1) * q0
        scale = p1 @ q1
        p1 = p1 / scale
        p0 = p0 / scale
        p0 = p0 - (p0 @ q1) * p1
        along_q0 = self.line(q0, 1.0).second
        return 0.5 * float(p1 @ along_q0 @ q0), float(p0 @ along_q0 @ q0 + p1 @ along_q0 @ q1)

    # ------------------------------------------------------------------ a pair
    def lyapunov(self, multiplier: complex) -> tuple[Coefficient, complex]:
        """(first Lyapunov coefficient, c) of a pair: d = Re(c / m) for maps, l1 = Re(c) / omega for flows.

        Parameters
        ----------
        multiplier : complex
            m on the unit circle (i omega for flows); the raw one of the problem's own period.
        """
        multiplier = 1j * multiplier.imag if self.flow else multiplier / abs(multiplier)
        pair = self._pair(multiplier)
        one, first = pair.vector, pair.a.second + 1j * pair.b.second
        mixed = 0.0 if self.flow else 1.0
        h11 = np.linalg.solve(self.closed_by(mixed), -np.real(first @ one.conj()))
        total = (pair.a.third + pair.b.third) @ one  # q q q* = (a^2 + b^2) q
        total = total + 2.0 * first @ self.extended(h11, 1.0)
        total = total + first.conj() @ self.extended(pair.h20, multiplier**2)
        c = complex(-0.5 * (pair.left @ total) / pair.weight)
        error = float(abs(self.n * (pair.a.third_error + 3.0 * pair.a.second_error) / pair.weight))
        if self.flow:
            omega = abs(multiplier.imag)
            return Coefficient(c.real / omega, error / omega), c
        return Coefficient(float((c / multiplier).real), error), c

    def fourth_order(self, multiplier: complex) -> dict[str, float]:
        """A = -i c / abs(d) at a resonance 1:4, where z -> i z + c z^2 z* + d z*^3."""
        multiplier = multiplier / abs(multiplier)
        _, c = self.lyapunov(multiplier)
        pair = self._pair(multiplier)
        a, b = pair.a, pair.b
        x, y = pair.vector.real, pair.vector.imag
        total = a.third @ x - 3.0 * b.third @ x - 1j * (3.0 * a.third @ y - b.third @ y)
        h02 = self.extended(pair.h20.conj(), multiplier.conjugate() ** 2)
        total = total + 3.0 * (a.second - 1j * b.second) @ h02
        d = complex(-(pair.left @ total) / (6.0 * pair.weight))
        A = -1j * c / abs(d)
        return {"A_re": A.real, "A_im": A.imag}

    def _pair(self, multiplier: complex) -> Pair:
        q, w = self.null(multiplier)
        # the phase in which real and imaginary parts are orthogonal
        square = np.sum(q * q)
        q = q * np.exp(-0.5j * np.angle(square)) if abs(square) > 1e-300 else q
        one: Any = self.extended(q, multiplier)
        a, b = self.line_of(one.real), self.line_of(one.imag)
        twice = 2.0 * multiplier if self.flow else multiplier**2
        h20 = np.linalg.solve(self.closed_by(twice), -((a.second + 1j * b.second) @ one))
        return Pair(one, w, a, b, h20, complex(w @ self.K @ q))


class Pitch(NamedTuple):
    """What a pair on the stability boundary does: first Lyapunov coefficient, and how it is to be read.

    Attributes
    ----------
    coefficient : float or None
        d of a cycle, l1 of an equilibrium; None where it cannot be had.
    criticality : {"supercritical", "subcritical"} or None
        Supercritical: a stable circle (cycle) is born where the motion has lost its stability.
    note : str
        A nearby strong resonance, or that the error is as large as the coefficient.
    """

    coefficient: float | None
    criticality: str | None
    note: str


RESONANT = 2e-3  # angle between a pair and a strong resonance at which the coefficient no longer decides
STRONG = {"1:1": 0.0, "1:2": np.pi, "1:3": 2.0 * np.pi / 3.0, "1:4": 0.5 * np.pi}


def strong_resonance(multiplier: complex) -> str:
    """The strong resonance at which a multiplier of the full period is, "1:3" for example; "" for none."""
    angle = abs(float(np.angle(multiplier)))
    return next((n for n, place in STRONG.items() if abs(angle - place) < RESONANT), "")


def pair_form(problem: Any, u: np.ndarray, p: float, spectrum: np.ndarray) -> Pitch:
    """The first Lyapunov coefficient at a Neimark-Sacker or Hopf point.

    Parameters
    ----------
    problem : Problem
    u, p
        The point.
    spectrum : ndarray of complex
        Raw multipliers there (of a flow they are computed here).
    """
    flow = problem.spectrum == "flow"
    if getattr(problem.kernels, "matrix", None) is None:
        return Pitch(None, None, "")
    try:
        forms = Forms(problem, u, p)
        values: Any = np.linalg.eigvals(forms.J) if flow else np.asarray(spectrum, dtype=complex)
        upper = values[values.imag > 0.0]
        if not len(upper):
            return Pitch(None, None, "")
        critical = complex(upper[np.argmin(np.abs(upper.real) if flow else np.abs(np.abs(upper) - 1.0))])
        found, _ = forms.lyapunov(critical)
    except (ValueError, IndexError, np.linalg.LinAlgError):
        return Pitch(None, None, "")
    value = float(found.value)
    if not np.isfinite(value):
        return Pitch(None, None, "")
    note = ""
    if not flow:
        resonance = strong_resonance(complex(np.asarray(problem.to_multipliers(np.array([critical])))[0]))
        note = f"near the strong resonance {resonance}" if resonance else ""
    if found.error > 0.5 * abs(value):
        return Pitch(value, None, "the first Lyapunov coefficient is zero within its error")
    return Pitch(value, "supercritical" if value < 0.0 else "subcritical", note)


def cubic_form(problem: Any, u: np.ndarray, p: float, flip: bool) -> float | None:
    """The cubic coefficient at a flip or pitchfork of a problem that says how long critical vectors are; else None.

    Parameters
    ----------
    problem : Problem
        With ``amplitude``: the length of a direction that is to be one.
    u, p
        The point.
    flip : bool
        Critical multiplier -1.
    """
    amplitude = getattr(problem, "amplitude", None)
    if amplitude is None or problem.spectrum == "none" or getattr(problem.kernels, "matrix", None) is None:
        return None
    factor = -1.0 if flip else (0.0 if problem.spectrum == "flow" else 1.0)
    try:
        forms = Forms(problem, u, p)
        found, length = forms.cubic(factor), amplitude(np.real(forms.null(factor)[0]))
    except (ValueError, IndexError, np.linalg.LinAlgError):
        return None
    value = found.value / length**2
    return float(value) if np.isfinite(value) and found.error < 1e-3 * abs(found.value) else None
