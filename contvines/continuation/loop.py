"""The continuation loop: predict, correct, judge the step; many points in one call.

This is the version for problems in Python; native/march.hpp has the same for compiled ones. Special points are not detected here.

Metric: <a, b> = a_u.b_u / N + a_p b_p / (hi - lo)^2, so that step lengths
depend neither on the number of repetitions of an orbit nor on the unit of the parameter. Unknowns of Python problems have
scales s: then a_u.b_u is the sum of a_j b_j / s_j^2 (the array ``weights``).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .corrector import Corrector, compare, extrapolate, plane
from .layout import MARGIN, NOTHING, NOWHERE, Aim, Chunk, Control, Found, Metric, Scratch, Status, Way
from .settings import SOLUTION, StepRule

if TYPE_CHECKING:
    from ..problems.protocol import KernelFunctions


class InterpretedLoop(Corrector):
    """March and single points of one problem in Python; overflows cause no warnings.

    Parameters
    ----------
    kernels, data, work, metric, noise, known, scratch
        See :class:`contvines.continuation.corrector.Corrector`.
    rule : StepRule
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
        rule: StepRule,
    ) -> None:
        super().__init__(kernels, data, work, metric, noise, bracket, scratch)
        self.rule = rule

    def points(self, way: Way, places: np.ndarray, found: Found, aim: Aim) -> int:
        """Solve for the points at some positions along a chord, or for the zero of an aim.

        Parameters
        ----------
        way : Way
        places : ndarray, shape (k,)
            Positions; not used with an aim.
        found : Found
            Filled: entry i for position i, entry 0 for the zero of an aim.
        aim : Aim
            Test function; with ``aim.test == NOTHING`` the points at `places` are computed.

        Returns
        -------
        int
            With an aim, see :meth:`contvines.continuation.corrector.Corrector.search`.
        """
        with np.errstate(all="ignore"):
            if aim.test != NOTHING:
                return self.search(way, found, aim)
            for i, s in enumerate(places):
                self.point(way, s, found, i)
        return NOWHERE

    @np.errstate(all="ignore")
    def march(self, chunk: Chunk, first: int, h: float, control: Control) -> tuple[int, float, int]:
        """Fill rows first, first + 1, ... of the arrays of a chunk with points of the branch.

        Row first - 1 contains the last known point, row first - 2 (if any) the one before it.

        The step rule (:class:`contvines.continuation.settings.StepRule`) judges each step and chooses the length of the next one. At an end of the
        interval the last point is corrected at the fixed parameter value, so that it lies exactly on the end.

        Parameters
        ----------
        chunk : Chunk
            Filled.
        first : int
            At least 1.
        h : float
            Length of the first step.
        control : Control

        Returns
        -------
        filled : int
            Number of filled rows.
        h : float
            Length of the next step.
        status : int
            A :class:`contvines.continuation.layout.Status`.
        """
        metric, judge, (u, border, _, tangent, _) = self.metric, self.rule.factor, self.scratch
        points, values, tangents, rows, signs, corrections = chunk.arrays
        angle, min_step, max_step, tolerance, lower, upper, stop_at_border, sweeps_allowed, margins, noise = (
            control
        )
        i = first
        trouble = 0
        while i < len(points):
            if h < min_step:
                return i, h, Status.NOT_EVALUABLE if trouble == -2 else Status.STEP_TOO_SMALL
            start = values[i - 1]
            p = extrapolate(points, values, tangents, i, h, metric, u)
            fixed = p > upper or p < lower
            length = h
            bound = upper if p > upper else lower
            if fixed:
                if start == bound:
                    return i, h, Status.LEFT_INTERVAL
                for _ in range(3):
                    if p != start:
                        length *= min(max((bound - start) / (p - start), 0.0), 1.5)
                    p = extrapolate(points, values, tangents, i, length, metric, u)
                p = target = bound
                border[:-1], border[-1] = 0.0, 1.0
            else:
                target = plane(tangents[i - 1], u, p, metric, border)
            points[i] = u
            guess = p
            p, sweeps, sign, size = self.correct(u, p, target, tolerance, sweeps_allowed)
            if sweeps < 0:
                trouble = sweeps
                h *= 0.5
                continue
            trouble = 0
            if metric.moving is not None:
                metric.moving.steer(u, tangent)
            norm, cosine, error = compare(tangent, tangents[i - 1], u, points[i], p, guess, metric)
            if fixed:
                p = bound
                if cosine < 0.0:
                    cosine = -cosine
                    norm = -norm
                if tangent[-1] * norm < 0.0:
                    sign = -sign
            turn = math.sqrt(max(0.0, 2.0 - 2.0 * cosine))
            factor = judge(turn, error, sweeps, length, angle, max(SOLUTION.rounding, noise))
            if not factor > 0.0:
                h = -factor * length
                continue
            if p > upper or p < lower:
                bound = upper if p > upper else lower
                h = length * max(0.5, (bound - start) / (p - start)) * 1.0000001
                if guess == p or start == bound:
                    return i, h, Status.LEFT_INTERVAL
                if h >= length:
                    h = 0.9 * length
                continue
            points[i], values[i], signs[i], corrections[i] = u, p, sign, size
            np.divide(tangent, norm, out=tangents[i])
            self.kernels.inspect(self.data, u, p, self.work, rows[i])
            i += 1
            if fixed:
                return i, h, Status.LEFT_INTERVAL
            h = min(h * factor, max_step)
            if stop_at_border and (rows[i - 1, margins:] < MARGIN).any():
                return i, h, Status.BORDER
        return i, h, Status.RUNNING
