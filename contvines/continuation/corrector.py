"""Corrector: Newton's method on the bordered system, along a branch and for single points.

This is the version for problems in Python, in which every unknown has its own scale; native/march.hpp has the same for compiled problems, whose
unknowns all have scale 1 and the same weight.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..problems.dense import dot, position
from .bracketing import Bracket
from .layout import AT_END, ENDS, JUMP, NOWHERE, PASSED, PRECISION, Aim, Found, Metric, Scratch, Way, probe
from .settings import SOLUTION

if TYPE_CHECKING:
    from ..problems.protocol import KernelFunctions

STRAY = 0.3  # largest distance of a point from the interpolation between the chord's ends, relative to the chord; else it is on another branch


def correction_size(step: np.ndarray, u: np.ndarray, p: float, metric: Metric) -> float:
    """Return the largest entry of a correction, relative to scale + abs(unknown); inf if it is not finite."""
    part = np.abs(u)
    part += metric.scale[:-1]
    np.divide(step[:-1], part, out=part)
    change = abs(float(step[-1])) / (float(metric.scale[-1]) + abs(p))
    if not dot(part, part) + change < math.inf:
        return math.inf
    return max(abs(float(part[position(part)])), change)


def plane(
    tangent: np.ndarray,
    u: np.ndarray,
    p: float,
    metric: Metric,
    border: np.ndarray,
) -> float:
    """Fill `border` with the normal of the plane through (u, p) orthogonal to a tangent; return border.(u, p)."""
    np.multiply(metric.weights, tangent, out=border)
    return dot(border, u, len(u)) + float(border[-1]) * p


def compare(
    tangent: np.ndarray,
    before: np.ndarray,
    u: np.ndarray,
    guess_u: np.ndarray,
    p: float,
    guess: float,
    metric: Metric,
) -> tuple[float, float, float]:
    """Return the length of a tangent, the cosine of its angle with the previous unit tangent, and the distance of a point from its guess."""
    weighted = metric.weights * tangent
    norm = math.sqrt(dot(weighted, tangent))
    gap = u - guess_u
    error = math.sqrt(dot(metric.weights[:-1] * gap, gap) + metric.of_parameter * (p - guess) ** 2)
    return norm, dot(weighted, before) / norm, error


def orient(
    tangent: np.ndarray,
    along: np.ndarray,
    border: np.ndarray,
    metric: Metric,
) -> tuple[float, float, float]:
    """Return the length of a tangent, its inner product with another vector, and border.tangent; the length is inf if an entry is not finite."""
    weighted = metric.weights * tangent
    norm = math.sqrt(dot(weighted, tangent)) if np.isfinite(tangent).all() else math.inf
    return norm, dot(weighted, along), dot(border, tangent)


def hermite(chord: np.ndarray, s: float, u: np.ndarray, guess: np.ndarray) -> float:
    """Interpolate with the cubic Hermite polynomial at s in [0, 1]: fill u and guess, return p. See :class:`contvines.bifurcation.locate.Segment`."""
    a, b = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2
    c, d = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)
    guess[:] = a * chord[0] + b * chord[1] + c * chord[2] + d * chord[3]
    u[:] = guess[:-1]
    return float(guess[-1])


def distance(u: np.ndarray, p: float, guess: np.ndarray, metric: Metric) -> float:
    """Return the distance of (u, p) from a guess."""
    gap = u - guess[:-1]
    return math.sqrt(dot(metric.weights[:-1] * gap, gap) + metric.of_parameter * (p - float(guess[-1])) ** 2)


def extrapolate(
    points: np.ndarray,
    values: np.ndarray,
    tangents: np.ndarray,
    i: int,
    h: float,
    metric: Metric,
    u: np.ndarray,
) -> float:
    """Extrapolate with the cubic Hermite polynomial over a length h from points i - 2 and i - 1: fill u, return p.

    The length of the arc between the two points is their distance times 1 + angle^2/24 (exact to fourth order). With a single point, or a much longer
    step, the extrapolation is linear.
    """
    last_tangent, value, point = tangents[i - 1], float(values[i - 1]), points[i - 1]
    if i >= 2:
        tangent_before = tangents[i - 2]
        chord, bend = point - points[i - 2], last_tangent - tangent_before
        change = value - float(values[i - 2])
        turn = dot(metric.weights * bend, bend)
        square = dot(metric.weights[:-1] * chord, chord) + metric.of_parameter * change**2
        d = math.sqrt(square) * (1.0 + turn / 24.0)
        if d > 0.0 and turn < 1.0 and h < 4.0 * d:
            share = h / d
            a = h * (1.0 + 2.0 * share + share * share)
            b = h * (share + share * share)
            c = h * (3.0 * share + 2.0 * share * share) / d
            chord *= -c
            chord += point
            displacement = a * last_tangent
            displacement += np.multiply(tangent_before, b, out=bend)
            np.add(chord, displacement[:-1], out=u)
            if metric.moving is not None:
                # no equation corrects these unknowns: errors grow with the formula above, but not with that of Adams and Bashforth
                held = metric.moving.held
                u[held] = point[held] + h * (
                    (1.0 + 0.5 * share) * last_tangent[:-1][held] - 0.5 * share * tangent_before[:-1][held]
                )
            return value - c * change + float(displacement[-1])
    np.add(point, h * last_tangent[:-1], out=u)
    return value + h * float(last_tangent[-1])


class Corrector:
    """Newton's method for one problem.

    Parameters
    ----------
    kernels, data, work
        Kernels, data and workspace of the problem.
    metric : Metric
    noise : float
        Noise of the equations: least size of corrections that can be computed; 0 if there is only rounding.
    known : ndarray
        Bracket of a search; see :mod:`contvines.continuation.layout`.
    scratch : Scratch
    """

    def __init__(
        self,
        kernels: KernelFunctions,
        data: object,
        work: object,
        metric: Metric,
        noise: float,
        bracket: np.ndarray,
        scratch: Scratch,
    ) -> None:
        self.kernels, self.data, self.work, self.metric = kernels, data, work, metric
        self.noise, self.bracket, self.scratch = noise, bracket, scratch

    def improve(
        self, u: np.ndarray, p: float, sweep: int, residual: float, before: float, tolerance: float
    ) -> tuple[float, float, int]:
        """Add the Newton correction to unknowns and parameter, unless Newton's method diverges.

        Parameters
        ----------
        u, p
            Unknowns (changed in place), parameter.
        sweep : int
            Number of corrections before this one.
        residual : float
            Largest residual before this correction.
        before : float
            Size of the correction before this one.
        tolerance : float
            Largest last correction.

        Returns
        -------
        p : float
        size : float
            Size of the correction, relative to the scale + abs(unknown).
        verdict : int
            1 if converged, -1 if diverged, else 0.
        """
        step, noise = self.scratch.step, self.noise
        size = correction_size(step, u, p, self.metric)
        if not size < SOLUTION.huge:
            return p, size, -1
        if sweep > 1 and size > 2.0 * before and size > max(SOLUTION.stalled, 10.0 * noise):
            return p, size, -1
        u += step[:-1]
        p += float(step[-1])
        if size <= max(min(SOLUTION.small, tolerance), noise):
            return p, size, 1
        if sweep > 0:
            ratio = size / before
            # quadratic convergence: the next correction would be about ratio^2 size
            if size <= tolerance and ratio * ratio * size <= max(SOLUTION.predicted, noise):
                return p, size, 1
            if size <= SOLUTION.stalled and ratio > 0.3 and residual < SOLUTION.solved:
                return p, size, 1
            # corrections at the level of the noise do not shrink
            if size <= 30.0 * noise and ratio > 0.1:
                return p, size, 1
        return p, size, 0

    def correct(
        self, u: np.ndarray, p: float, target: float, tolerance: float, max_sweeps: int
    ) -> tuple[float, int, float, float]:
        """Solve F(u, p) = 0, border.(u, p) = target by Newton's method; u is updated in place, the border is that of the scratch arrays.

        Returns
        -------
        p : float
        sweeps : int
            Number of sweeps; -1: no convergence; -2: not evaluable.
        sign : float
            Sign of the bordered determinant at the last linearisation, before the last correction.
        size : float
            Size of the last correction, relative to the scale + abs(unknown).
        """
        kernels, data, work, (_, border, step, tangent, _) = self.kernels, self.data, self.work, self.scratch
        size, sign, n, of_parameter = 0.0, 0.0, len(u), float(border[-1])
        for sweep in range(max_sweeps):
            residual = kernels.linearise(data, u, p, work)
            if not math.isfinite(residual):
                return p, -2, sign, size
            gap = target - of_parameter * p - dot(border, u, n)
            sign = kernels.bordered(data, work, border, gap, step, tangent)
            p, size, verdict = self.improve(u, p, sweep, residual, size, tolerance)
            if verdict != 0:
                return p, sweep + 1 if verdict > 0 else -1, sign, size
        return p, -1, sign, size

    def point(self, way: Way, s: float, found: Found, i: int) -> None:
        """Solve for the point at position s on a chord, and write it with tangent, row and numbers to entry i of `found`."""
        kernels, data, work = self.kernels, self.data, self.work
        border, u, tangent = way.border, found.u[i], found.tangents[i]
        p = hermite(way.chord, s, u, self.scratch.guess)
        limit = 0 if way.length > 0.0 and (s == 0.0 or s == 1.0) else way.sweeps
        target = way.start + s * way.length
        residual, sign, size, sweeps, settled = 0.0, 0.0, 0.0, -1, limit == 0
        for sweep in range(limit + 1):
            residual = kernels.linearise(data, u, p, work)
            if not math.isfinite(residual):
                sweeps = -2
                break
            gap = target - float(border[-1]) * p - dot(border, u, len(u))
            sign = kernels.bordered(data, work, border, gap, self.scratch.step, tangent)
            if settled:
                sweeps = sweep
                break
            if sweep == limit:
                break
            p, size, verdict = self.improve(u, p, sweep, residual, size, SOLUTION.rounding)
            if verdict < 0:
                break
            settled = verdict > 0
        if sweeps >= 0:
            kernels.inspect(data, u, p, work, found.rows[i])
            norm, same, rise = orient(tangent, way.along, border, self.metric)
            if not math.isfinite(norm):
                sweeps = -3
            else:
                if same < 0.0:
                    norm, rise = -norm, -rise
                tangent /= norm
                if rise < 0.0:
                    sign = -sign
                if way.length > 0.0 and distance(u, p, self.scratch.guess, self.metric) > STRAY * way.length:
                    sweeps = -4
        found.numbers[i] = p, sweeps, residual, sign, size

    def search(self, way: Way, found: Found, aim: Aim) -> int:
        """Find the zero of an aim's test function between a chord's ends, and write its point to the first entry of `found`.

        ``bracket`` gives tolerance and jump of :class:`contvines.continuation.bracketing.Bracket`, and receives the final bracket.

        Returns
        -------
        int
            `PASSED` if a zero was bracketed, `AT_END` if an end is taken as the zero, `NOWHERE` if there is none.
        """
        ends = self.bracket

        def value(s: float) -> tuple[float, float]:
            self.point(way, s, found, 0)
            p, sweeps, _, sign, _ = found.numbers[0].tolist()
            return probe(aim, found.rows[0], found.tangents[0, -1], sign) if sweeps >= 0 else math.nan, p

        first, first_p = value(0.0)
        if not math.isfinite(first):
            return NOWHERE
        last, last_p = value(1.0)
        if not math.isfinite(last):
            return NOWHERE
        smallest, largest = sorted((abs(first), abs(last)))
        if first * last > 0.0:
            # an end that is itself the zero may have either sign, by rounding
            if aim.anyway == 0 and smallest > SOLUTION.solved * largest:
                return NOWHERE
            outcome, evaluated, end = AT_END, 1.0, 0.0 if abs(first) < abs(last) else 1.0
            ends[0] = end
        else:
            bracket = Bracket(1.0, last, last_p, 0.0, first, first_p, *ends[[PRECISION, JUMP]].tolist())
            evaluated, outcome, end = bracket.narrow(value), PASSED, bracket.best
            ends[ENDS] = bracket.x1, bracket.f1, bracket.p1, bracket.x2, bracket.f2, bracket.p2
        if end != evaluated or found.numbers[0, 1] < 0.0:  # evaluate the best position again
            value(end)
        return outcome
