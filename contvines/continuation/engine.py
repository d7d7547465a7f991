"""Engine: a problem with its continuation loop, work arrays and metric; solves single points to rounding."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contvines.shared.numbers import EPSILON

from ..core.library import native
from ..core.table import TableKernels
from ..long_work import HELD, OPEN
from ..problems.abilities import Adaptive, Moving, Nearing, Rough
from ..problems.protocol import Problem, array_of
from .layout import (
    AT_END,
    ENDS,
    JUMP,
    NO_COLUMNS,
    NOTHING,
    NOWHERE,
    PRECISION,
    SIZE,
    Aim,
    Control,
    Found,
    Metric,
    Scratch,
    Way,
    solved_point,
)
from .layout import Hit as Hit
from .layout import Solved as Solved
from .settings import SOLUTION, Settings

if TYPE_CHECKING:
    from .loop import InterpretedLoop
    from .native import NativeLoop


NOISY = 30.0  # least tolerance of Newton corrections, in units of the noise of the equations
ONE = np.zeros(1)  # positions of a single point: the chord's first end
NO_AIM = Aim(NOTHING, NO_COLUMNS)


def parameter_unit(within: tuple[float, float], p: float, scale: float = 1.0) -> float:
    """Return the unit of parameter differences near p: the larger one of |p| and `scale`, but at most the length of the interval."""
    size, length = -p if p < 0.0 else p, within[1] - within[0]  # called often: no function calls inside
    unit = size if size > scale else scale
    return unit if unit < length else length


def _extreme_of_rows(extreme: np.ufunc, rows: np.ndarray) -> np.ndarray:
    """Return the smallest or largest entry of each row; for few columns column by column, which takes a tenth of the time."""
    if rows.ndim == 1 or rows.shape[-1] > 16:
        return np.asarray(extreme.reduce(rows, axis=-1))
    found = rows[..., 0].copy()
    for j in range(1, rows.shape[-1]):
        extreme(found, rows[..., j], out=found)
    return found


class Engine:
    """Continuation of one problem within an interval.

    Parameters
    ----------
    problem : Problem
    within : (float, float)
        Interval of the parameter; its length is the unit of the parameter in the metric.
    settings : Settings

    Attributes
    ----------
    n, m : int
        Numbers of unknowns and of multipliers.
    row_size : int
        Length of a row: 2 m plus the number of margins.
    detection : {"map", "flow", "real", "none"}
        Kind of spectrum used for detection; see :data:`contvines.continuation.layout.KINDS`.
    compiled : bool
        Whether the loop runs in the native core.
    scale, weights : ndarray, shape (N + 1,)
        Typical sizes of unknowns and parameter, and their weights in the metric.
    noise : float
        Noise of the equations; 0 if there is only rounding.
    plain : bool
        Whether all unknowns have scale 1.
    shift : ndarray, shape (N,), or None
        Change of the unknowns by a shift of one period; None if zero.
    rate : float
        Unit of raw eigenvalues; 1 for multipliers.
    row_sizes : ndarray, shape (N,)
        Typical sizes of the equations.
    scaled, exchanges : bool
        Whether the problem has scales; whether also two multipliers that cross in opposite directions are sought
        (:func:`contvines.bifurcation.scan.balance`).
    many, signed : bool
        Whether eigenvalues are computed only near branch points; whether the sign of det F_u is known. See
        :class:`contvines.problems.abilities.Nearing`.
    adaptive, moving : Problem or None
        The problem, if its mesh is adapted along the branch; if its mesh moves with the solution.
    """

    def __init__(self, problem: Problem, within: tuple[float, float], settings: Settings) -> None:
        self.problem, self.settings = problem, settings
        self.lower, self.upper = float(within[0]), float(within[1])
        self.within = (self.lower, self.upper)
        n = self.n = int(problem.dimension)
        kernels = self.kernels = problem.kernels
        self.compiled = kernels.compiled and native()
        self.section = HELD if self.compiled else OPEN
        self.data = problem.data
        self.work = problem.workspace()
        self.m = int(problem.n_multipliers)
        self.detection = problem.detection or problem.spectrum
        self.row_size = 2 * self.m + int(problem.n_margins)
        self.scale, self.noise = problem.scale_within(self.within), float(problem.noise)
        self.plain = bool((self.scale[:-1] == 1.0).all())
        shift = np.asarray(0.0 if problem.period_shift is None else problem.period_shift, dtype=float)
        self.shift = shift if shift.any() else None
        scales = problem.scales
        self.rate = 1.0 if scales is None or self.detection != "flow" else float(scales.rate)
        self.row_sizes = np.ones(n) if scales is None else scales.rows
        self.scaled = scales is not None
        self.exchanges = self.scaled and self.detection != "none"
        nearing = problem if isinstance(problem, Nearing) else None
        self.many, self.signed = nearing is not None and nearing.many, nearing is None or nearing.signed
        self.adaptive = problem if isinstance(problem, Adaptive) else None
        self.weights = 1.0 / (n * self.scale**2)
        self.weights[n] = 1.0 / (self.upper - self.lower) ** 2
        self.moving = problem if isinstance(problem, Moving) else None
        self.metric = Metric(self.weights, self.scale, 1.0 / n, float(self.weights[n]), self.moving)
        self.scratch = Scratch(np.zeros(n), *np.zeros((4, n + 1)))
        self.control = Control(
            settings.angle,
            settings.min_step,
            settings.max_step,
            max(settings.tolerance, NOISY * self.noise),  # not below the noise of the equations
            self.lower,
            self.upper,
            0,
            settings.max_iterations,
            2 * self.m,
            self.noise,
        )
        self._rows = np.zeros((0, self.row_size))
        self.guess = np.zeros((4, n + 1))  # data of a chord of which only the first end is used
        self.nothing, self.at_parameter = np.zeros(n + 1), np.zeros(n + 1)
        self.at_parameter[n] = 1.0
        self.bracket = np.zeros(SIZE)
        self.loop = self.loop_with(self.metric)

    def loop_with(self, metric: Metric) -> InterpretedLoop | NativeLoop:
        """Return the loop for march and single points: in the native core for compiled problems, if it is used, else in Python."""
        kernels = self.kernels
        rest = metric, self.noise, self.bracket, self.scratch, self.settings.step_rule
        if self.compiled and isinstance(kernels, TableKernels):
            from .native import NativeLoop

            return NativeLoop(kernels.table, self.data, self.work, (self.n, self.row_size), *rest)
        from .loop import InterpretedLoop

        return InterpretedLoop(kernels, self.data, self.work, *rest)

    def parameter_unit(self, p: float) -> float:
        """Return the unit of parameter differences near p; see :func:`parameter_unit`."""
        return parameter_unit(self.within, p, float(self.scale[-1]))

    def upright(self, p: float) -> float:
        """Return the parameter's component of a unit tangent below which the branch is upright."""
        return self.settings.upright * self.parameter_unit(p)

    def settled(self, p: float) -> float:
        """Return the largest change of the parameter near p that is rounding, or noise of the equations."""
        return max(self.settings.rounding, 10.0 * self.noise) * self.parameter_unit(p)

    def size(self, u: np.ndarray) -> float:
        """Return 1 + the largest unknown in units of its scale."""
        return 1.0 + float((np.abs(u) / self.scale[:-1]).max())

    # ------------------------------------------------------------------ metric
    def inner(self, a: np.ndarray, b: np.ndarray) -> float:
        """Return the inner product <a, b> in the metric."""
        return float((self.weights * a).dot(b))

    def norm(self, a: np.ndarray) -> float:
        """Return the length of a vector in the metric."""
        return math.sqrt((self.weights * a).dot(a))

    def distance(self, a: Solved, b: Solved) -> float:
        """Return the distance of two points in the metric."""
        return self.norm(self.join(b.u - a.u, b.p - a.p))

    def amplitude(self, a: np.ndarray) -> float:
        """Return the length of a vector in the norm of normal forms."""
        return self.problem.amplitude(a)

    def unit(self, a: np.ndarray) -> np.ndarray:
        """Return the vector scaled to length 1 in the metric."""
        return a / self.norm(a)

    @staticmethod
    def join(u: np.ndarray, p: float) -> np.ndarray:
        """Return (u, p) as one vector, shape (N + 1,)."""
        z = np.empty(len(u) + 1)
        z[:-1], z[-1] = u, p
        return z

    def across(self, u: np.ndarray, p: float, tangent: np.ndarray) -> Solved | None:
        """Solve for the solution in the plane through a guess that is orthogonal to a direction; None without convergence."""
        border = self.weights * tangent
        return self.solve(u, p, border, float(border @ self.join(u, p)), tangent)

    def beside(self, point: Solved, step: float) -> Solved | None:
        """Solve for the solution at a distance along the tangent of a known one; None without convergence."""
        guess = self.join(point.u, point.p) + step * point.tangent
        return self.across(guess[:-1], float(guess[-1]), point.tangent)

    # ------------------------------------------------------------------ rows: multipliers as (re, im) pairs, then margins
    def rows(self, count: int) -> np.ndarray:
        """Return an array for rows; the same memory at every call."""
        if len(self._rows) < count:
            self._rows = np.zeros((count, self.row_size))
        return self._rows[:count]

    def spectrum(self, rows: np.ndarray) -> NDArray[np.complex128]:
        """Return the raw multipliers of some rows, shape (..., m)."""
        pairs = np.ascontiguousarray(rows[..., : 2 * self.m])
        return pairs.view(np.complex128) + 0.0  # a copy, without negative zeros

    def margins(self, rows: np.ndarray) -> np.ndarray:
        """Return the margins of some rows, shape (..., n_margins); NaN (not applicable) becomes inf."""
        return np.fmin(rows[..., 2 * self.m :], np.inf)

    def smallest_margin(self, rows: np.ndarray) -> np.ndarray:
        """Return the smallest margin of each row, +inf without margins."""
        margins = rows[..., 2 * self.m :]  # fmin ignores NaN
        if margins.ndim == 1 or not margins.shape[-1]:
            return np.fmin.reduce(margins, axis=-1, initial=np.inf)
        return np.fmin(_extreme_of_rows(np.fmin, margins), np.inf)

    def multipliers(self, rows: np.ndarray) -> np.ndarray:
        """Return the multipliers of the full period of some rows, shape (..., m)."""
        return np.asarray(self.problem.to_multipliers(self.spectrum(rows)), dtype=complex)

    @property
    def tells_stability(self) -> bool:
        """Whether the problem has a spectrum that decides stability; else stability is not computed."""
        return self.problem.spectrum in ("map", "flow")

    def stable(self, rows: np.ndarray) -> np.ndarray:
        """Return whether all multipliers are inside the unit circle (left of the imaginary axis for flows); False if unknown."""
        return self.outermost(rows) < 0.0

    def outermost(self, rows: np.ndarray) -> np.ndarray:
        """Return by how much the outermost multiplier is outside the unit circle (right of the imaginary axis for flows); NaN if unknown."""
        if not self.tells_stability:
            return np.full(rows.shape[:-1], np.nan)
        if not self.m:
            return np.full(rows.shape[:-1], -np.inf)
        spectrum = self.spectrum(rows)
        if self.problem.spectrum == "flow":
            return _extreme_of_rows(np.maximum, spectrum.real)
        return _extreme_of_rows(np.maximum, np.abs(spectrum)) - 1.0

    # ------------------------------------------------------------------ single points
    def solve(
        self,
        u: np.ndarray,
        p: float,
        border: np.ndarray,
        target: float,
        along: np.ndarray | None = None,
        sweeps: int = 40,
    ) -> Solved | None:
        """Solve for the solution with border.(u, p) = target near a guess, to rounding; None if Newton's method does not converge.

        Parameters
        ----------
        u, p
            Guess.
        border : ndarray, shape (N + 1,)
            Row that makes the system square, metric included.
        target : float
        along : ndarray, optional
            The tangent is returned with <along, tangent> > 0; by default with <border, tangent> > 0.
        sweeps : int
            Largest number of corrections.
        """
        self.guess[0, : self.n], self.guess[0, self.n] = u, p
        along = self.nothing if along is None else along
        return solved_point(self._run(Way(self.guess, float(target), 0.0, border, along, sweeps), ONE)[0], 0)

    def polish(
        self, u: np.ndarray, p: float, border: np.ndarray, target: float, along: np.ndarray | None = None
    ) -> Solved | None:
        """Linearise at a point without correcting it; return it with residual, tangent, spectrum and margins."""
        return self.solve(u, p, border, target, along, 0)

    def on_chord(self, way: Way, places: np.ndarray) -> Found:
        """Solve for the points of a branch at positions along a chord."""
        return self._run(way, places)[0]

    def search(self, way: Way, aim: Aim, tolerance: float, jump: float) -> Hit | None:
        """Locate the zero of an aim's test function along a chord; None if there is none.

        Parameters
        ----------
        way : Way
        aim : Aim
        tolerance, jump : float
            See :class:`contvines.continuation.bracketing.Bracket`.
        """
        bracket = self.bracket
        bracket[PRECISION], bracket[JUMP] = tolerance, jump
        found, outcome = self._run(way, ONE, aim)
        if outcome == NOWHERE:
            return None
        point = solved_point(found, 0)
        one, f_one, p_one, other, f_other, p_other = bracket[ENDS].tolist()
        if outcome == AT_END or point is None:
            return Hit(one, point, 0.0, 0.0)
        place = one if abs(f_one) < abs(f_other) else other
        width = abs(p_one - p_other) + 2.0 * EPSILON * abs(point.p)
        return Hit(place, point, max(width, SOLUTION.left * point.correction), abs(f_one - f_other))

    def _run(self, way: Way, places: np.ndarray, aim: Aim = NO_AIM) -> tuple[Found, int]:
        """Run the loop for single points; return the points, and the outcome of an aim."""
        k, n = len(places), self.n
        found = Found(np.empty((k, n)), np.empty((k, n + 1)), np.zeros((k, self.row_size)), np.empty((k, 5)))
        with self.section:
            return found, self.loop.points(way, places, found, aim)

    def at_value(self, u: np.ndarray, p: float, along: np.ndarray | None = None) -> Solved | None:
        """Solve for the solution at a fixed parameter value; None without convergence."""
        return self.solve(u, p, self.at_parameter, p, along)

    def start(self, u: np.ndarray, p: float, tangent: np.ndarray | None = None) -> Solved | None:
        """Solve for a first point near (u, p), inside the interval; None if there is none.

        With a tangent the point lies in the plane orthogonal to it. Else it is sought at fixed p; if that fails or leads far away, as near a fold, also
        at a fixed unknown, and the nearest of the points found is returned.
        """
        u = np.asarray(u, dtype=float)
        if tangent is not None and np.any(tangent):
            tangent = self.unit(np.asarray(tangent, dtype=float))
            found = self.across(u, p, tangent)
            if found is not None and self.lower <= found.p <= self.upper:
                return found
        found, p = None, min(max(p, self.lower), self.upper)
        if tangent is None and not self.compiled and isinstance(self.problem, Rough):
            from ..problems.scouting import approach

            near = approach(self.problem, u, p)
            found = None if near is None else self.at_value(near, p)
        found = found or self.at_value(u, p)
        if found is not None and (self._near_guess(u, found) or self.residual(u, p) >= SOLUTION.solved):
            return found
        fixed = np.eye(min(self.n, 8), self.n + 1)
        others = [self.solve(u, p, border, float(u[i])) for i, border in enumerate(fixed)]
        inside = [
            other for other in (found, *others) if other is not None and self.lower <= other.p <= self.upper
        ]
        return min(inside, key=lambda other: self._distance_to(u, p, other), default=None)

    def _near_guess(self, u: np.ndarray, found: Solved) -> bool:
        """Whether a solution at the guess's parameter is so near to the guess that it may be the same solution.

        Near a fold the distance may be as large as the square root of the residual.
        """
        return self._distance_to(u, found.p, found) <= math.sqrt(SOLUTION.solved)

    @np.errstate(all="ignore")  # a solution far away may cause overflow
    def _distance_to(self, u: np.ndarray, p: float, found: Solved) -> float:
        """Return the distance of a solution from a guess."""
        return self.norm(self.join(found.u - u, found.p - p))

    def residual(self, u: np.ndarray, p: float) -> float:
        """Linearise at (u, p) in the work arrays, and return the largest absolute residual."""
        with np.errstate(all="ignore"):
            return float(self.kernels.linearise(self.data, np.array(u, dtype=float), float(p), self.work))

    def apply_inverse(self, border: np.ndarray, side: np.ndarray) -> np.ndarray:
        """Solve [[F_u, F_p], [border]] x = side with the linearisation in the work arrays."""
        array_of(self.work).reshape(-1)[:] = -side[: self.n]
        step, tangent = np.empty((2, self.n + 1))
        with np.errstate(all="ignore"):
            self.kernels.bordered(self.data, self.work, border, float(side[self.n]), step, tangent)
        return step
