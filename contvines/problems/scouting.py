"""Scouting: damped Newton's method from a rough guess to a solution, and a coarse trace of its branch to learn the scales.

Full Newton steps may jump across a fold to another solution, or diverge; damped steps converge to the solution to which the guess
belongs, or fail. The step lengths are those of Deuflhard, Newton methods for nonlinear problems, Springer 2004, algorithm NLEQ-ERR (section
3.3.3): they do not depend on the scaling of the equations.

The scales of a problem made of Python callables are learned by a short, coarse continuation in both directions from its start. Its metric
grows with the unknowns. Only the scales are kept.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contvines.shared.numbers import TINY

from .abilities import Rough
from .functions import NotEvaluable
from .protocol import Equations, array_of
from .scales import Scales, in_fields, of_parameter, of_rounding, weighed
from .settings import DERIVATIVES, SCALES

if TYPE_CHECKING:
    from types import ModuleType

    from .dense import DenseWork
    from .derivatives import Differentiated
    from .large.sparse import SparseWork


DAMPED = 80  # most steps of damped Newton's method
STEPS = {30: 60, 500: 24}  # most unknowns: continuation steps each way; FEW for problems with more unknowns
FEW = 6
LONGEST = 0.5  # largest continuation step, in the metric
# sum of the angles between tangents (rad) at which the trace ends: the branch has shown its scales
TOTAL_TURN = 3.0
TURN = 0.6  # largest angle (rad) between successive tangents
SLOW = 0.2  # a branch runs away if the parameter moves by less than this part of its range while the unknowns double theirs
MOST = 64  # most unknowns that are tested for being zeros up to rounding
SAMPLES = 4  # points at which the typical magnitude of the eigenvalues is computed


class RoughProblem(Equations, Rough, Protocol):
    """A problem with ``residuals`` and ``lengths``, which may begin at a rough guess."""


class Unscaled(RoughProblem, Protocol):
    """A problem whose scales can be learned: the members of :class:`contvines.problems.callables.CallableProblem` that `Scout` uses."""

    functions: Differentiated

    @property
    def u0(self) -> np.ndarray: ...
    @property
    def p0(self) -> float: ...
    @property
    def algebra(self) -> ModuleType: ...
    def workspace(self) -> DenseWork | SparseWork: ...
    def of_unknowns(self, each: np.ndarray) -> np.ndarray: ...
    def rates(self, work: DenseWork | SparseWork) -> list[float]: ...


def approach(problem: RoughProblem, u: np.ndarray, p: float) -> np.ndarray | None:
    """Return a point near the solution to which damped Newton's method converges at a fixed parameter; None if it fails.

    Parameters
    ----------
    problem : RoughProblem
    u : ndarray, shape (N,)
    p : float

    Returns
    -------
    ndarray or None
        Of shape (N,), so near the solution that full steps converge; `u` itself if they converge from there.
    """
    work, kernels, n = problem.workspace(), problem.kernels, len(u)
    F = array_of(work)
    border, scale = np.zeros(n + 1), np.maximum(problem.lengths, SCALES.barely * np.abs(u))
    border[n] = 1.0

    def size(correction: np.ndarray) -> float:
        found = float((np.abs(correction) / (scale + np.abs(u))).max())
        return found if found == found else math.inf

    def correction() -> tuple[np.ndarray, float]:
        step, tangent = np.zeros(n + 1), np.zeros(n + 1)
        sign = kernels.bordered(problem.data, work, border, 0.0, step, tangent)
        return step[:n], sign

    def linearised(at: np.ndarray) -> bool:
        return bool(kernels.linearise(problem.data, at, p, work) < math.inf)

    u, damping = np.array(u, dtype=float), 1.0
    if not linearised(u):
        return None
    step, sign = correction()
    for _ in range(DAMPED):
        length = size(step)
        if not length < math.inf:
            return None
        if length < SCALES.near:
            return u
        while True:
            if damping < SCALES.shortest:
                return None
            trial = u + damping * step
            F[:] = _value(problem, trial, p)
            simplified = correction()[0] if np.isfinite(F).all() else np.full(n, np.nan)
            if size(simplified) < (1.0 - 0.25 * damping) * length and linearised(trial):
                ahead, new_sign = correction()
                if new_sign * sign >= 0.0:
                    break
                linearised(
                    u
                )  # the sign of the determinant has changed: beyond the singular Jacobian lies another solution
            bend = size(simplified - (1.0 - damping) * step)
            shorter = 0.5 * length * damping**2 / bend if 0.0 < bend < math.inf else 0.0
            damping = min(max(shorter, 0.1 * damping), 0.5 * damping)
        gap = size(simplified - ahead) * size(ahead)
        damping = min(1.0, damping * length * size(simplified) / gap) if gap > 0.0 else 1.0
        u, step, sign = trial, ahead, new_sign
    return None


def _value(problem: RoughProblem, u: np.ndarray, p: float) -> np.ndarray:
    """F, or NaN where it cannot be evaluated."""
    with np.errstate(all="ignore"):
        try:
            return problem.residuals(u, p)
        except ArithmeticError:
            return np.full(len(u), np.nan)


class Scout:
    """A coarse predictor-corrector method whose scales grow with the unknowns.

    Parameters
    ----------
    problem : Unscaled
    within : (float, float)
        Parameter interval.
    given : ndarray, optional
        Scales of the unknowns, if the user has given them.
    """

    def __init__(
        self, problem: Unscaled, within: tuple[float, float], given: np.ndarray | None = None
    ) -> None:
        self.problem, self.within, self.n = problem, within, int(problem.dimension)
        self.width = within[1] - within[0]
        self.kernels, self.work = problem.kernels, problem.workspace()
        # a length below this share of the unknown itself is an effect of rounding
        self.first = np.maximum(problem.lengths, SCALES.barely * np.abs(np.asarray(problem.u0, dtype=float)))
        start = np.abs(np.asarray(problem.u0, dtype=float))
        far = (start > 0.0) & (SCALES.rounding * self.first > start)
        if far.any():
            u0, p0 = np.asarray(problem.u0, dtype=float), float(problem.p0)
            terms = of_parameter(lambda p: problem.residuals(u0, p), p0)
            far &= ~of_rounding(lambda u: problem.residuals(u, p0), u0, terms)
        self.first = np.where(far, start, self.first)
        self.scale = self.first.copy()
        self.low = self.high = np.append(problem.u0, problem.p0)
        self.before = np.zeros(self.n + 1)  # ranges of (u, p) when one of them last doubled
        self.rows = np.zeros(self.n)
        self.rates: list[float] = []
        self.noise = 0.0
        self.known = problem.of_unknowns(problem.functions.known)
        self.given = given is not None
        if given is not None:
            self.first, self.scale = given, given.copy()

    # ------------------------------------------------------------------ one point
    def weights(self) -> np.ndarray:
        """Weights of the metric for (u, p)."""
        return np.append(1.0 / (self.n * self.scale**2), 1.0 / self.width**2)

    def _length(self, vector: np.ndarray) -> float:
        return math.sqrt(float((self.weights() * vector) @ vector))

    def _correct(
        self, z: np.ndarray, border: np.ndarray, sweeps: int
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Newton's method with border.z held fixed: the solution and its tangent, or None."""
        z, target = z.copy(), float(border @ z)
        step, tangent = np.zeros(self.n + 1), np.zeros(self.n + 1)
        before = math.inf
        for sweep in range(sweeps):
            if not self.kernels.linearise(self.problem.data, z[:-1], float(z[-1]), self.work) < math.inf:
                return None
            self.kernels.bordered(
                self.problem.data, self.work, border, target - float(border @ z), step, tangent
            )
            size = float((np.abs(step[:-1]) / (self.scale + np.abs(z[:-1]))).max())
            size = max(size, abs(float(step[-1])) / self.width)
            if not math.isfinite(size) or (sweep > 3 and size > 2.0 * before and size > SCALES.near):
                return None
            z += step
            if size < SCALES.close or (size < SCALES.near and size > 0.3 * before):
                return (z, tangent) if np.isfinite(tangent).all() else None
            before = size
        return None

    def _record(self, z: np.ndarray, first: bool) -> None:
        """Update ranges, scales and sizes of the equations with a new point."""
        if first:
            self.low = self.high = z
        self.low, self.high = np.minimum(self.low, z), np.maximum(self.high, z)
        extent = 0.5 * (self.high - self.low)[:-1]
        self.scale = in_fields(np.maximum(self.first, extent))
        self.rows = np.maximum(self.rows, self._row_changes(self.scale, self.width))
        if len(self.rates) < SAMPLES:
            self.rates += self.problem.rates(self.work)

    # ------------------------------------------------------------------ the trace
    def start(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Return a solution near the start, with the parameter or an unknown held fixed, and its tangent; None if there is none."""
        z = np.append(self.problem.u0, self.problem.p0)
        near = approach(self.problem, z[:-1], float(z[-1]))
        if near is not None:
            z[:-1] = near
        for i in (self.n, *range(min(self.n, 8))):
            border = np.zeros(self.n + 1)
            border[i] = 1.0
            found = self._correct(z, border, 40)
            if found is not None and self.within[0] <= found[0][-1] <= self.within[1]:
                self._take_from_tangent(*found)
                self._record(found[0], True)
                return found
        return None

    def _take_from_tangent(self, z: np.ndarray, tangent: np.ndarray) -> None:
        """Set unknown sizes to the distance an unknown moves along the tangent while another one, or the parameter, moves by its own size.

        Unknowns that do not move get the size at which their terms in an equation are as large as those of the others.
        """
        known = self.known
        if self.given or known.all():
            return
        rates, sizes = np.abs(tangent), np.append(self.first, self.width)
        moves = (rates > 0.0) & self._confirmed(tangent)  # at a fold the parameter stands still
        moving, free = np.append(known, True) & moves, ~known & moves[:-1]
        if moving.any() and free.any():
            length = float((sizes[moving] / rates[moving]).min())
            self.first = np.where(free, np.maximum(rates[:-1] * length, TINY), self.first)
        self.first, weighable = self._weighed(z, known | free)
        self.known, self.scale = known | (weighable & ~free), self.first.copy()

    def _weighed(self, z: np.ndarray, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lengths from the terms of the equations at z, see `weighed`; and which unknowns have known lengths then."""
        if not isinstance(self.work.jacobian, np.ndarray):
            return self.first, known

        def near_zero(v: np.ndarray) -> np.ndarray:
            try:
                return self.problem.residuals(z[:-1] + v, float(z[-1]))
            except NotEvaluable:
                return np.full(self.n, np.nan)

        return weighed(near_zero, self.work.jacobian, self.first, known)

    def _row_changes(self, scale: np.ndarray, width: float) -> np.ndarray:
        """Largest change of each equation when one unknown changes by its scale or the parameter by `width`, by the last linearisation."""
        return np.maximum(
            self.problem.algebra.row_sizes(self.work, scale), np.abs(self.work.derivative) * width
        )

    def listen(self, tangent: np.ndarray) -> None:
        """Set ``noise``: how far noise of the equations moves the last linearised solution across the branch, relative to its scale."""
        noise = self.problem.functions.noise
        if not noise.any():
            return
        normal = self.weights() * tangent
        step, response = np.zeros((2, self.n + 1))
        self.work.residual[:] = np.tile(noise, self.n // len(noise))
        border = normal / np.abs(normal).max()
        self.kernels.bordered(self.problem.data, self.work, border, 0.0, step, response)
        distance = float((np.abs(step[:-1]) / self.scale).max())
        if np.isfinite(distance) and distance > DERIVATIVES.roundoff:
            self.noise = min(distance, DERIVATIVES.largest)

    def _confirmed(self, tangent: np.ndarray) -> np.ndarray:
        """Which entries of a tangent are not rounding errors: they do not change if another border is used."""
        step, other = np.zeros(self.n + 1), np.zeros(self.n + 1)
        border = np.random.default_rng(9).uniform(0.5, 1.0, self.n + 1) / np.append(self.first, self.width)
        self.kernels.bordered(self.problem.data, self.work, border, 0.0, step, other)
        weighed = self.weights() * tangent
        with np.errstate(all="ignore"):
            other = other * (float(weighed @ tangent) / float(weighed @ other))
            return np.abs(other - tangent) <= 0.01 * np.abs(tangent)

    def walk(self, z: np.ndarray, tangent: np.ndarray, steps: int) -> None:
        """Follow the branch for some steps in the direction of the tangent."""
        h, turned = 0.02, 0.0
        for _ in range(steps):
            tangent = tangent / self._length(tangent)
            guess, border = z + h * tangent, self.weights() * tangent
            found = self._correct(guess, border, 7)
            if found is None:
                h *= 0.25
                continue
            ahead = found[1] / self._length(found[1])
            cosine = float((self.weights() * tangent) @ ahead)
            turn = math.sqrt(max(0.0, 2.0 - 2.0 * cosine))
            if turn > TURN or self._length(found[0] - guess) > h:
                h *= 0.3
                continue
            if not self.within[0] <= found[0][-1] <= self.within[1]:
                return
            if not self.before.any():
                self.before = self.high - self.low
            z, tangent, turned = found[0], ahead, turned + turn
            self._record(z, False)
            if turned > TOTAL_TURN or self._runs_away():
                return
            h = min(1.7 * h, LONGEST)

    def _runs_away(self) -> bool:
        """Whether the unknowns have doubled their range since the last call while the parameter hardly moved."""
        extent = self.high - self.low
        doubled = np.any((extent[:-1] > 2.0 * self.before[:-1]) & (self.before[:-1] > 0.0))
        if not doubled:
            return False
        moved, in_all = extent[-1] - self.before[-1], extent[-1]
        self.before = extent
        return bool(moved < SLOW * in_all)

    def _rounding(self, size: np.ndarray) -> dict[int, float]:
        """Unknowns that are zeros up to rounding, since they are too small for an effect on any equation; each with the size at which it has one."""
        found: dict[int, float] = {}
        for j in np.flatnonzero((size > 0.0) & (size < SCALES.rounding * size.max()))[:MOST]:
            unit = np.zeros(self.n)
            unit[j] = 1.0
            change = self._row_changes(unit, 0.0)
            reach = np.divide(self.rows, change, out=np.full(self.n, np.inf), where=change > 0.0).min()
            if np.isfinite(reach) and size[j] < SCALES.rounding * reach:
                found[int(j)] = float(reach)
        return found

    def scales(self, given: np.ndarray | None) -> Scales:
        """Return the learned scales; those of the unknowns are replaced by ``given``."""
        extent = 0.5 * (self.high - self.low)
        size = np.maximum(np.abs(self.high), np.abs(self.low))[:-1]
        lost = self._rounding(size)
        size[list(lost)] = 0.0
        bends, first = self.problem.of_unknowns(self.problem.functions.bends), self.first
        certain = bends | self.known
        # a zero moved by rounding has no size of its own
        least = np.where(np.asarray(self.problem.u0) == 0.0, SCALES.faint, SCALES.rounding)
        sizes = np.where(size > np.where(certain, least * first, 0.0), size, first)
        moved = extent[:-1] > np.where(
            bends, SCALES.moves * np.minimum(first, sizes), SCALES.barely * np.where(certain, first, sizes)
        )
        rest = np.where(certain, first, np.where(size > 0.0, size, 1.0))
        for j, reach in lost.items():
            moved[j], rest[j] = False, first[j] if certain[j] else reach
        learned = np.where(bends, np.maximum(extent[:-1], np.minimum(first, 2.0 * extent[:-1])), extent[:-1])
        sizes = np.maximum(np.where(moved, learned, rest), SCALES.barely * size)
        far = (extent[:-1] > SCALES.moves * size) | (np.where(bends, extent[:-1], 0.0) > first)
        travelled = bool(np.any(far)) or bool(extent[-1] > SCALES.travelled * self.width)
        if not travelled:  # nothing was learned: use the unknowns' own sizes, and the whole interval
            sizes = np.where(size > 0.0, size, 1.0)
        unknowns = in_fields(sizes) if given is None else given
        unit_learned = min(self.width, 2.0 * extent[-1])
        unit = float(unit_learned) if travelled and extent[-1] > 0.0 else self.width
        rows = np.where(self.rows > 0.0, self.rows, 1.0)
        rate = float(np.exp(np.mean(np.log(self.rates)))) if self.rates else 1.0
        unscaled = np.flatnonzero(~certain & ~moved & (size == 0.0)) if given is None else ()
        return Scales(unknowns, unit, rows, rate, self.noise, tuple(int(i) for i in unscaled))


def learn(problem: Unscaled, within: tuple[float, float], given: np.ndarray | None = None) -> Scales:
    """Learn the scales of a problem within a parameter interval.

    Parameters
    ----------
    problem : Unscaled
    within : (float, float)
    given : ndarray, optional
        Scales of the unknowns, if the user has given them.
    """
    scout = Scout(problem, within, given)
    begin = scout.start()
    if begin is None:
        return Scales(in_fields(scout.first), scout.width, np.ones(scout.n), 1.0, 0.0)
    z, tangent = begin
    scout.listen(tangent)
    steps = next((steps for most, steps in STEPS.items() if scout.n <= most), FEW)
    scout.walk(z, tangent, steps)
    scout.walk(z, -tangent, steps)
    return scout.scales(given)
