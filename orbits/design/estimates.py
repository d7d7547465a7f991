"""Estimates: least squares with confidence intervals from the curvature of the sum of squares.

Linearised about the estimate, with Student's t: sources of scatter that the model does not have are in the residual, and so in the
intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from orbits.machines.base import ParameterError
from orbits.settings import DESIGNING

WIDEST = 0.1  # step of differences, of the limits' span
AGREEING = 0.3  # relative difference of slopes from one step and from four times that, where data are smooth


@dataclass(frozen=True, eq=False)
class Calibration:
    """Estimated parameters.

    Attributes
    ----------
    values : dict
        Estimates.
    intervals : dict
        Name -> (low, high) at `confidence`, cut off at the limits.
    confidence : float
    scatter : float
        Standard deviation of the residuals, in the unit of the data.
    residuals : float array
    correlation : float array (n, n)
        Of the estimates: near 1 or -1 the data cannot tell two of them apart.
    between : float
        Of impacts: the mean time from one to the next, in the unit of the data.
    """

    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    confidence: float
    scatter: float
    residuals: np.ndarray = field(repr=False)
    correlation: np.ndarray = field(repr=False)
    between: float = math.nan

    def __str__(self) -> str:
        lines = [
            f"{name} = {value:.6g}, {100 * self.confidence:g} % between {self.intervals[name][0]:.6g} and {self.intervals[name][1]:.6g}"
            for name, value in self.values.items()
        ]
        return "\n".join([*lines, f"scatter of the data about the model: {self.scatter:.3g}"])


def fit(
    residuals: Callable[[np.ndarray], np.ndarray],
    guess: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]],
    confidence: float = 0.95,
    spent: int = 0,
) -> Calibration:
    """Least squares with confidence intervals.

    Parameters
    ----------
    residuals : callable
        Data minus model at parameter values (n,), shape (m,).
    guess : mapping
        Where the search begins.
    limits : mapping
        Name -> (low, high).
    confidence : float
    spent : int
        Degrees of freedom of the data that something else than the parameters has used up.

    Raises
    ------
    ParameterError
        If there are fewer data than parameters, or they do not depend on one of them.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t

    names = list(guess)
    start = np.array([float(guess[name]) for name in names])
    low, high = (np.array([limits[name][k] for name in names], dtype=float) for k in (0, 1))
    if np.any(start < low) or np.any(start > high):
        raise ParameterError("the guess leaves the limits: begin inside them")
    if not 0.0 < confidence < 1.0:
        raise ParameterError(f"confidence = {confidence!r}: give a number between 0 and 1, for example 0.95")
    span = high - low
    found = least_squares(
        residuals,
        start,
        bounds=(low, high),
        x_scale=span,
        diff_step=DESIGNING.difference,
        xtol=DESIGNING.estimated,
        ftol=DESIGNING.estimated,
        gtol=DESIGNING.flat,
        method="trf",
    )
    data, unknowns = found.fun.size - spent, len(names)
    if data <= unknowns:
        raise ParameterError(f"{data} data do not fix {unknowns} parameters: measure more, or estimate fewer")
    scatter = math.sqrt(float(found.fun @ found.fun) / (data - unknowns))
    wide = float(t.ppf(0.5 + 0.5 * confidence, data - unknowns))
    jacobian = _effects(residuals, found.x, low, high, wide * scatter)
    _, sizes, axes = np.linalg.svd(jacobian * span, full_matrices=False)
    if sizes[-1] <= DESIGNING.independent * sizes[0]:
        flat = names[int(np.argmax(np.abs(axes[-1])))]
        raise ParameterError(
            f"the data do not depend on {flat} (alone): leave it out, or measure something that does"
        )
    covariance = scatter**2 * np.linalg.inv(jacobian.T @ jacobian)
    deviations = np.sqrt(np.diag(covariance))
    reach = wide * deviations
    return Calibration(
        dict(zip(names, map(float, found.x))),
        {
            name: (float(max(x - r, a)), float(min(x + r, b)))
            for name, x, r, a, b in zip(names, found.x, reach, low, high)
        },
        confidence,
        scatter,
        found.fun,
        covariance / np.outer(deviations, deviations) if scatter > 0.0 else np.eye(unknowns),
    )


def _effects(
    residuals: Callable[[np.ndarray], np.ndarray],
    x: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    scatter: float,
) -> np.ndarray:
    """How the residuals change per change of a parameter, shape (m, n).

    By derivatives where the data are smooth. Responses also jump from one motion to another, and jitter where the motion does not
    settle: there a derivative says nothing, or much too much. Where differences over four times the step do not agree, steps are
    widened until they reach as far as a residual of size `scatter` lets the parameter go.
    """
    columns = []
    for j in range(x.size):
        step = DESIGNING.effect * (high[j] - low[j])
        slope = _slope(residuals, x, j, step, low, high)
        while step < WIDEST * (high[j] - low[j]) and np.linalg.norm(slope) * step > scatter:
            wider = _slope(residuals, x, j, 4.0 * step, low, high)
            if np.linalg.norm(wider - slope) < AGREEING * np.linalg.norm(slope):
                break
            step, slope = 4.0 * step, wider
        columns.append(slope)
    return np.column_stack(columns)


def _slope(
    residuals: Callable[[np.ndarray], np.ndarray],
    x: np.ndarray,
    j: int,
    step: float,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """Central difference with respect to parameter j; at a limit to one side."""
    below, above = x.copy(), x.copy()
    below[j], above[j] = max(x[j] - step, low[j]), min(x[j] + step, high[j])
    return (residuals(above) - residuals(below)) / (above[j] - below[j])
