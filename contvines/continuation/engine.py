"""Engine: a problem with its loop, work arrays and metric; solves single points tightly."""

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


NOISY = 30.0  # times their noise: corrections of noisy equations may be as large at a solution
ONE = np.zeros(1)  # a single place: the chord's first end
NO_AIM = Aim(NOTHING, NO_COLUMNS)


def parameter_unit(within: tuple[float, float], p: float, scale: float = 1.0) -> float:
    """Length of the parameter near p: the interval's, but an interval of silly width does not make neighbours the same."""
    size, length = -p if p < 0.0 else p, within[1] - within[0]  # asked for often: no calls
    own = size if size > scale else scale
    return own if own < length else length


def _of_rows(extreme: np.ufunc, rows: np.ndarray) -> np.ndarray:
    """The smallest or largest of each row; of few columns a column at a time, which takes a tenth of a reduction's time."""
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
        self.plain = bool((self.scale[:-1] == 1.0).all())  # unknowns have no scales of their own
        shift = np.asarray(0.0 if problem.period_shift is None else problem.period_shift, dtype=float)
        self.shift = shift if shift.any() else None  # what a period adds to the unknowns, if anything
        scales = problem.scales
        self.rate = (
            1.0 if scales is None or self.detection != "flow" else float(scales.rate)
        )  # of one raw eigenvalue
        self.row_sizes = np.ones(n) if scales is None else scales.rows
        # what the rows of multipliers tell: of problems with many unknowns eigenvalues only where they are asked for
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
            max(
                settings.tolerance, NOISY * self.noise
            ),  # below what the noise of the equations allows is none
            self.lower,
            self.upper,
            0,
            settings.max_iterations,
            2 * self.m,
            self.noise,
        )
        self._rows = np.zeros((0, self.row_size))
        self.guess = np.zeros((4, n + 1))  # a chord of which the first end alone is used
        self.nothing, self.at_parameter = np.zeros(n + 1), np.zeros(n + 1)
        self.at_parameter[n] = 1.0
        self.known = np.zeros(SIZE)
        self.loop = self.loop_with(self.metric)

    def loop_with(self, metric: Metric) -> InterpretedLoop | NativeLoop:
        """March and single points, in the native core for compiled problems where there is one."""
        kernels, rest = self.kernels, (metric, self.noise, self.known, self.scratch, self.settings.step_rule)
        if self.compiled and isinstance(kernels, TableKernels):
            from .native import NativeLoop

            return NativeLoop(kernels.table, self.data, self.work, (self.n, self.row_size), *rest)
        from .loop import InterpretedLoop

        return InterpretedLoop(kernels, self.data, self.work, *rest)

    def parameter_unit(self, p: float) -> float:
        """What differences of the parameter near p are compared with."""
        return parameter_unit(self.within, p, float(self.scale[-1]))

    def upright(self, p: float) -> float:
        """The parameter's part of a unit tangent below which the branch stands upright."""
        return self.settings.upright * self.parameter_unit(p)

    def settled(self, p: float) -> float:
        """Changes of the parameter near p that are rounding, or the noise of the equations."""
        return max(self.settings.rounding, 10.0 * self.noise) * self.parameter_unit(p)

    def size(self, u: np.ndarray) -> float:
        """1 + the largest unknown, in units of the scale."""
        return 1.0 + float((np.abs(u) / self.scale[:-1]).max())

    # ------------------------------------------------------------------ metric
    def inner(self, a: np.ndarray, b: np.ndarray) -> float:
        """<a, b>."""
        return float((self.weights * a).dot(b))

    def norm(self, a: np.ndarray) -> float:
        """Length of a vector."""
        return math.sqrt((self.weights * a).dot(a))

    def distance(self, a: Solved, b: Solved) -> float:
        """Length of the way from one point to another."""
        return self.norm(self.join(b.u - a.u, b.p - a.p))

    def amplitude(self, a: np.ndarray) -> float:
        """Length of a unit vector as normal forms measure it."""
        return self.problem.amplitude(a)

    def unit(self, a: np.ndarray) -> np.ndarray:
        """The vector scaled to length 1."""
        return a / self.norm(a)

    @staticmethod
    def join(u: np.ndarray, p: float) -> np.ndarray:
        """(u, p) as one vector."""
        z = np.empty(len(u) + 1)
        z[:-1], z[-1] = u, p
        return z

    def across(self, u: np.ndarray, p: float, tangent: np.ndarray) -> Solved | None:
        """The solution across a direction through a guess."""
        border = self.weights * tangent
        return self.solve(u, p, border, float(border @ self.join(u, p)), tangent)

    def beside(self, point: Solved, step: float) -> Solved | None:
        """The solution at a distance along the tangent of a known one."""
        guess = self.join(point.u, point.p) + step * point.tangent
        return self.across(guess[:-1], float(guess[-1]), point.tangent)

    # ------------------------------------------------------------------ rows: multipliers as (re, im) pairs, then margins
    def rows(self, count: int) -> np.ndarray:
        """Room for rows, the same one every time: large, written once and read once."""
        if len(self._rows) < count:
            self._rows = np.zeros((count, self.row_size))
        return self._rows[:count]

    def spectrum(self, rows: np.ndarray) -> NDArray[np.complex128]:
        """Raw multipliers of some rows, shape (..., m)."""
        pairs = np.ascontiguousarray(rows[..., : 2 * self.m])
        return pairs.view(np.complex128) + 0.0  # a copy, without negative zeros

    def margins(self, rows: np.ndarray) -> np.ndarray:
        """Margins of some rows, shape (..., n_margins); NaN counts as not applicable."""
        return np.fmin(rows[..., 2 * self.m :], np.inf)

    def smallest_margin(self, rows: np.ndarray) -> np.ndarray:
        """Smallest margin of each row, +inf where there are none."""
        margins = rows[..., 2 * self.m :]  # fmin passes over NaN
        if margins.ndim == 1 or not margins.shape[-1]:
            return np.fmin.reduce(margins, axis=-1, initial=np.inf)
        return np.fmin(_of_rows(np.fmin, margins), np.inf)

    def multipliers(self, rows: np.ndarray) -> np.ndarray:
        """Multipliers of the full period, shape (..., m)."""
        return np.asarray(self.problem.to_multipliers(self.spectrum(rows)), dtype=complex)

    @property
    def tells_stability(self) -> bool:
        """Whether the problem has a spectrum that tells stability; else it is not computed."""
        return self.problem.spectrum in ("map", "flow")

    def stable(self, rows: np.ndarray) -> np.ndarray:
        """Whether all multipliers are inside the unit circle (left of the imaginary axis for flows); False where nothing says."""
        return self.outermost(rows) < 0.0

    def outermost(self, rows: np.ndarray) -> np.ndarray:
        """How far the outermost multiplier is outside the unit circle (right of the imaginary axis for flows); NaN where nothing says."""
        if not self.tells_stability:
            return np.full(rows.shape[:-1], np.nan)
        if not self.m:
            return np.full(rows.shape[:-1], -np.inf)
        spectrum = self.spectrum(rows)
        if self.problem.spectrum == "flow":
            return _of_rows(np.maximum, spectrum.real)
        return _of_rows(np.maximum, np.abs(spectrum)) - 1.0

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
        """The solution with border.(u, p) = target near a guess, to roundoff; None if Newton does not converge.

        Parameters
        ----------
        u, p
            Guess.
        border : ndarray, shape (N + 1,)
            Row that makes the system square, metric included.
        target : float
        along : ndarray, optional
            The tangent is returned with <along, tangent> > 0; else with <border, tangent> > 0.
        sweeps : int
            Corrections at most.
        """
        self.guess[0, : self.n], self.guess[0, self.n] = u, p
        along = self.nothing if along is None else along
        return solved_point(self._run(Way(self.guess, float(target), 0.0, border, along, sweeps), ONE)[0], 0)

    def polish(
        self, u: np.ndarray, p: float, border: np.ndarray, target: float, along: np.ndarray | None = None
    ) -> Solved | None:
        """Linearise at a point that is already good: residual, tangent, spectrum and margins belong to it."""
        return self.solve(u, p, border, target, along, 0)

    def on_chord(self, way: Way, places: np.ndarray) -> Found:
        """The points of a branch at places along a chord."""
        return self._run(way, places)[0]

    def search(self, way: Way, aim: Aim, tolerance: float, jump: float) -> Hit | None:
        """The point of a branch along a chord at which a number passes zero; None if there is none.

        Parameters
        ----------
        way : Way
        aim : Aim
        tolerance, jump : float
            See :class:`contvines.continuation.bracketing.Bracket`.
        """
        known = self.known
        known[PRECISION], known[JUMP] = tolerance, jump
        found, outcome = self._run(way, ONE, aim)
        if outcome == NOWHERE:
            return None
        point = solved_point(found, 0)
        one, f_one, p_one, other, f_other, p_other = known[ENDS].tolist()
        if outcome == AT_END or point is None:
            return Hit(one, point, 0.0, 0.0)
        place = one if abs(f_one) < abs(f_other) else other
        width = abs(p_one - p_other) + 2.0 * EPSILON * abs(point.p)
        return Hit(place, point, max(width, SOLUTION.left * point.correction), abs(f_one - f_other))

    def _run(self, way: Way, places: np.ndarray, aim: Aim = NO_AIM) -> tuple[Found, int]:
        k, n = len(places), self.n
        found = Found(np.empty((k, n)), np.empty((k, n + 1)), np.zeros((k, self.row_size)), np.empty((k, 5)))
        with self.section:
            return found, self.loop.points(way, places, found, aim)

    def at_value(self, u: np.ndarray, p: float, along: np.ndarray | None = None) -> Solved | None:
        """The solution at a fixed parameter value, or None."""
        return self.solve(u, p, self.at_parameter, p, along)

    def start(self, u: np.ndarray, p: float, tangent: np.ndarray | None = None) -> Solved | None:
        """A first point near (u, p): at fixed p within the interval, or, where that fails or leads away (at a fold), nearest to the guess."""
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
        if found is not None and (self._near(u, found) or self.residual(u, p) >= SOLUTION.solved):
            return found
        fixed = np.eye(min(self.n, 8), self.n + 1)
        others = [self.solve(u, p, border, float(u[i])) for i, border in enumerate(fixed)]
        inside = [
            other for other in (found, *others) if other is not None and self.lower <= other.p <= self.upper
        ]
        return min(inside, key=lambda other: self._off(u, p, other), default=None)

    def _near(self, u: np.ndarray, found: Solved) -> bool:
        """Whether a solution is as near to a guess as one that has the guess's parameter may be where the guess is a solution, too.

        Beside a fold that is the square root of a residual.
        """
        return self._off(u, found.p, found) <= math.sqrt(SOLUTION.solved)

    @np.errstate(all="ignore")  # what Newton's method has run away to may be larger than all numbers
    def _off(self, u: np.ndarray, p: float, found: Solved) -> float:
        """Length of the way from a guess to a solution."""
        return self.norm(self.join(found.u - u, found.p - p))

    def residual(self, u: np.ndarray, p: float) -> float:
        """Largest absolute residual; linearises."""
        with np.errstate(all="ignore"):
            return float(self.kernels.linearise(self.data, np.array(u, dtype=float), float(p), self.work))

    def apply_inverse(self, border: np.ndarray, side: np.ndarray) -> np.ndarray:
        """Solve [[F_u, F_p], [border]] x = side with the linearisation in the work arrays."""
        array_of(self.work).reshape(-1)[:] = -side[: self.n]
        step, tangent = np.empty((2, self.n + 1))
        with np.errstate(all="ignore"):
            self.kernels.bordered(self.data, self.work, border, float(side[self.n]), step, tangent)
        return step
