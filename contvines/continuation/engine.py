"""Engine: a problem with its bound loop, work arrays and metric; solves single points tightly."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..interrupts import HELD, OPEN
from ..problems.abilities import Rough
from ..problems.protocol import Problem
from . import corrector
from . import loop as source
from .approach import approach
from .binding import bind
from .lengths import Metric
from .settings import Settings

NOISY = 30.0  # times their noise: corrections of noisy equations may be as large at a solution
NO_ROW = np.zeros(1)


def parameter_unit(within: tuple[float, float], p: float, scale: float = 1.0) -> float:
    """Length of the parameter near p: the interval's, but an interval of silly width does not make neighbours the same."""
    return min(within[1] - within[0], max(scale, abs(p)))


def _of_rows(extreme: np.ufunc, rows: np.ndarray) -> np.ndarray:
    """The smallest or largest of each row; of few columns a column at a time, which takes a tenth of a reduction's time."""
    if rows.ndim == 1 or rows.shape[-1] > 16:
        return np.asarray(extreme.reduce(rows, axis=-1))
    found = rows[..., 0].copy()
    for j in range(1, rows.shape[-1]):
        extreme(found, rows[..., j], out=found)
    return found


class Solved(NamedTuple):
    """A point of a branch with everything known about it.

    ``row`` is what the kernel ``inspect`` wrote: multipliers as re, im pairs, then margins. ``tangent`` is a unit vector
    in the metric, ``sign`` the sign of det [[F_u, F_p], [tangent]], ``correction`` the last Newton correction.
    """

    u: np.ndarray
    p: float
    tangent: np.ndarray
    row: np.ndarray
    sign: float
    residual: float
    correction: float


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
        self.bound = bind(problem.kernels, settings.step_rule)
        self.section = HELD if problem.kernels.compiled else OPEN
        self.data = problem.data
        self.work = problem.workspace()
        self.m = int(problem.n_multipliers)
        self.detection = problem.detection or problem.spectrum
        self.row_size = 2 * self.m + int(problem.n_margins)
        self.scale, self.noise = problem.scale_within(self.within), float(problem.noise)
        scales = problem.scales
        self.rate = (
            1.0 if scales is None or self.detection != "flow" else float(scales.rate)
        )  # of one raw eigenvalue
        self.row_sizes = np.ones(n) if scales is None else scales.rows
        self.weights = 1.0 / (n * self.scale**2)
        self.weights[n] = 1.0 / (self.upper - self.lower) ** 2
        self.metric = Metric(self.weights, self.scale, 1.0 / n, float(self.weights[n]))
        self.scratch = corrector.Scratch(np.zeros(n), *np.zeros((4, n + 1)))
        control = np.zeros(source.CONTROL_SIZE)
        control[source.ANGLE] = settings.angle
        control[source.MIN_STEP], control[source.MAX_STEP] = settings.min_step, settings.max_step
        # a tolerance below what the noise of the equations allows is none
        control[source.TOLERANCE] = max(settings.tolerance, NOISY * self.noise)
        control[source.SWEEPS] = settings.max_iterations
        control[source.LOWER], control[source.UPPER] = self.lower, self.upper
        control[source.ROW_MARGINS] = 2 * self.m
        control[source.NOISE] = self.noise
        self.control = control
        self._rows = np.zeros((0, self.row_size))
        self.guess = np.zeros((4, n + 1))  # a chord of which the first end alone is used
        self.nothing, self.at_parameter = np.zeros(n + 1), np.zeros(n + 1)
        self.at_parameter[n] = 1.0

    def parameter_unit(self, p: float) -> float:
        """What differences of the parameter near p are compared with."""
        return parameter_unit(self.within, p, float(self.scale[-1]))

    def size(self, u: np.ndarray) -> float:
        """1 + the largest unknown, in units of the scale."""
        return 1.0 + float((np.abs(u) / self.scale[:-1]).max())

    # ------------------------------------------------------------------ metric
    def inner(self, a: np.ndarray, b: np.ndarray) -> float:
        """<a, b>."""
        return float(np.dot(self.weights * a, b))

    def norm(self, a: np.ndarray) -> float:
        """Length of a vector."""
        return math.sqrt(max(self.inner(a, a), 0.0))

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

    # ------------------------------------------------------------------ single points
    def solve(
        self, u: np.ndarray, p: float, border: np.ndarray, target: float, along: np.ndarray | None = None
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
        """
        return self._solved(u, float(p), border, float(target), 40, along)

    def polish(
        self, u: np.ndarray, p: float, border: np.ndarray, target: float, along: np.ndarray | None = None
    ) -> Solved | None:
        """Linearise at a point that is already good: residual, tangent, spectrum and margins belong to it."""
        return self._solved(u, float(p), border, float(target), 0, along)

    def _solved(
        self,
        u: np.ndarray,
        p: float,
        border: np.ndarray,
        target: float,
        sweeps: int,
        along: np.ndarray | None,
    ) -> Solved | None:
        self.guess[0, : self.n], self.guess[0, self.n] = u, p
        return self._point(self.guess, (0.0, target, 0.0), border, along, sweeps)

    def on_chord(
        self, chord: np.ndarray, s: float, start: float, length: float, border: np.ndarray, along: np.ndarray
    ) -> Solved | None:
        """The point of a branch at a distance along a chord; see :func:`contvines.continuation.corrector.point`."""
        return self._point(chord, (s, start, length), border, along, 40)

    def _point(
        self,
        chord: np.ndarray,
        place: tuple[float, float, float],
        border: np.ndarray,
        along: np.ndarray | None,
        sweeps: int,
    ) -> Solved | None:
        here, tangent, row = np.empty(self.n), np.empty(self.n + 1), np.zeros(self.row_size)
        with self.section, np.errstate(all="ignore"):
            p, sweeps, residual, sign, size = self.bound.point(
                self.data,
                self.work,
                corrector.EVERYTHING,
                chord,
                place,
                border,
                self.nothing if along is None else along,
                sweeps,
                here,
                tangent,
                row,
                self.metric,
                self.scratch,
                self.noise,
            )
        return Solved(here, p, tangent, row, sign, residual, size) if sweeps >= 0 else None

    def at_value(self, u: np.ndarray, p: float, along: np.ndarray | None = None) -> Solved | None:
        """The solution at a fixed parameter value, or None."""
        return self.solve(u, p, self.at_parameter, p, along)

    def start(self, u: np.ndarray, p: float, tangent: np.ndarray | None = None) -> Solved | None:
        """A first point near (u, p): at fixed p, or, where that fails (at a fold), nearest to the guess."""
        if tangent is not None and np.any(tangent):
            tangent = self.unit(np.asarray(tangent, dtype=float))
            border = self.weights * tangent
            found = self.solve(u, p, border, float(np.dot(border, self.join(u, p))), tangent)
            if found is not None and self.lower <= found.p <= self.upper:
                return found
        found = None
        if tangent is None and not self.problem.kernels.compiled and isinstance(self.problem, Rough):
            near = approach(self.problem, np.asarray(u, dtype=float), p)
            found = None if near is None else self.at_value(near, p)
        if found is None:
            found = self.at_value(np.asarray(u, dtype=float), p)
        if found is None:
            for i in range(min(self.n, 8)):
                border = np.zeros(self.n + 1)
                border[i] = 1.0
                found = self.solve(np.asarray(u, dtype=float), p, border, float(u[i]))
                if found is not None and self.lower <= found.p <= self.upper:
                    break
                found = None
        return found

    def residual(self, u: np.ndarray, p: float) -> float:
        """Largest absolute residual."""
        self.guess[0, : self.n], self.guess[0, self.n] = u, p
        return float(self._part(corrector.LINEARISE, self.nothing, 0.0)[2])

    def apply_inverse(self, border: np.ndarray, side: np.ndarray) -> np.ndarray:
        """Solve [[F_u, F_p], [border]] x = side with the linearisation in the work arrays."""
        self.work[0].reshape(-1)[:] = -side[: self.n]
        self._part(corrector.ELIMINATE, border, float(side[self.n]))
        return self.scratch.step.copy()

    def _part(self, what: int, border: np.ndarray, target: float) -> tuple[float, int, float, float, float]:
        return self.bound.point(
            self.data,
            self.work,
            what,
            self.guess,
            (0.0, target, 0.0),
            border,
            self.nothing,
            0,
            self.scratch.u,
            self.scratch.tangent,
            NO_ROW,
            self.metric,
            self.scratch,
            self.noise,
        )

    # ------------------------------------------------------------------ rows
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
        margins = rows[..., 2 * self.m :]
        return np.where(np.isnan(margins), np.inf, margins)

    def smallest_margin(self, rows: np.ndarray) -> np.ndarray:
        """Smallest margin of each row, +inf where there are none."""
        if rows.shape[-1] <= 2 * self.m:
            return np.full(rows.shape[:-1], np.inf)
        margins = rows[..., 2 * self.m :]  # fmin passes over NaN
        if margins.ndim == 1:
            return np.asarray(min((value for value in margins.tolist() if value == value), default=np.inf))
        smallest = _of_rows(np.fmin, margins)
        return np.where(np.isnan(smallest), np.inf, smallest)

    def multipliers(self, rows: np.ndarray) -> np.ndarray:
        """Multipliers of the full period, shape (..., m)."""
        return np.asarray(self.problem.to_multipliers(self.spectrum(rows)), dtype=complex)

    def stable(self, rows: np.ndarray) -> np.ndarray:
        """Whether all multipliers are inside the unit circle (left of the imaginary axis for flows)."""
        return self.outermost(rows) < 0.0

    def outermost(self, rows: np.ndarray) -> np.ndarray:
        """How far the outermost multiplier is outside the unit circle (right of the imaginary axis for flows); NaN where nothing says."""
        if self.problem.spectrum not in ("map", "flow"):
            return np.full(rows.shape[:-1], np.nan)
        if not self.m:
            return np.full(rows.shape[:-1], -np.inf)
        spectrum = self.spectrum(rows)
        if self.problem.spectrum == "flow":
            return _of_rows(np.maximum, spectrum.real)
        return _of_rows(np.maximum, np.abs(spectrum)) - 1.0
