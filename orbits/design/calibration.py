"""Calibration: restitution, friction and other parameters from measured impact times or from a measured sweep.

Least squares through simulated motions, with confidence intervals from the curvature of the sum of squares (linearised about the estimate,
Student's t): sources of scatter that the model does not have are in the residual, and so in the intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from orbits.machines.base import ParameterError

GRID = 9  # values per parameter at which the search for a guess looks
SETTLED = 400  # forcing periods before a steady response is read


@dataclass(frozen=True, eq=False)
class Calibration:
    """Estimated parameters.

    Attributes
    ----------
    values : dict
        Estimates.
    intervals : dict
        Name -> (low, high) at `confidence`.
    confidence : float
    scatter : float
        Standard deviation of the residuals, in the unit of the data.
    residuals : float array
    correlation : float array (n, n)
        Of the estimates: near 1 or -1 the data cannot tell two of them apart.
    """

    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    confidence: float
    scatter: float
    residuals: np.ndarray = field(repr=False)
    correlation: np.ndarray = field(repr=False)

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
        diff_step=1e-5,
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-14,
        method="trf",
    )
    data, unknowns = found.fun.size, len(names)
    if data <= unknowns:
        raise ParameterError(f"{data} data do not fix {unknowns} parameters: measure more, or estimate fewer")
    jacobian = _slopes(residuals, found.x, span)
    _, sizes, axes = np.linalg.svd(jacobian * span, full_matrices=False)
    if sizes[-1] <= 1e-10 * sizes[0]:
        flat = names[int(np.argmax(np.abs(axes[-1])))]
        raise ParameterError(
            f"the data do not depend on {flat} (alone): leave it out, or measure something that does"
        )
    scatter = math.sqrt(float(found.fun @ found.fun) / (data - unknowns))
    covariance = scatter**2 * np.linalg.inv(jacobian.T @ jacobian)
    deviations = np.sqrt(np.diag(covariance))
    reach = float(t.ppf(0.5 + 0.5 * confidence, data - unknowns)) * deviations
    return Calibration(
        dict(zip(names, map(float, found.x))),
        {name: (float(x - r), float(x + r)) for name, x, r in zip(names, found.x, reach)},
        confidence,
        scatter,
        found.fun,
        covariance / np.outer(deviations, deviations) if scatter > 0.0 else np.eye(unknowns),
    )


def from_impacts(
    machine: Any,
    times: Sequence[float] | np.ndarray,
    unknown: Mapping[str, float],
    *,
    start: Mapping[str, float] | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    confidence: float = 0.95,
) -> Calibration:
    """From the instants of successive impacts.

    The first impact is taken as the origin; what is compared are the times since then, so that the clock of the measurement needs
    no phase. Parameters to which time is proportional cannot be told from it.

    Parameters
    ----------
    machine : Model
    times : sequence of float
        Seconds for a physical machine, else 1/omega_0; ascending.
    unknown : mapping
        Parameters to be estimated, with guesses; of a physical machine counted in its units.
    start : mapping, optional
        State in which the measurement begins (see `orbits.simulation.simulate`): from rest by default.
    limits : mapping, optional
    confidence : float

    Raises
    ------
    ParameterError
        If the times cannot be, or the model has fewer impacts than were measured.
    """
    from orbits.simulation import simulate

    measured = _measured(times)
    model = _with_amounts(machine, unknown)
    bounds = _limits(model, unknown, limits)
    since = measured - measured[0]
    count = measured.size

    def residuals(values: np.ndarray, used: int = count) -> np.ndarray:
        params = _vector(model, dict(zip(unknown, values)))
        numbers: dict[str, Any] = dict(zip(model.parameter_names, (float(x) for x in params)))
        run = simulate(model, start, events=40 * used + 400, **numbers)
        phases = run.phases[run.codes < 2][:used]
        if phases.size < used:
            return np.full(used - 1, 1e3 * float(since[-1]))
        seconds = float(model.gauge("time", params))
        return ((phases - phases[0]) / numbers["frequency"] * seconds - since[:used])[1:]

    return fit(residuals, _nearer(residuals, unknown, bounds, count), bounds, confidence)


def _nearer(
    residuals: Callable[..., np.ndarray],
    guess: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]],
    count: int,
) -> dict[str, float]:
    """A guess good enough for all impacts: from the best of a grid for the first few, with more and more of them.

    Motions with impacts forget: a wrong guess is soon out of step, and the sum over many impacts has many minima.
    """
    from scipy.optimize import least_squares

    few = min(count, 2 * len(guess) + 2)
    low, high = (np.array([limits[name][k] for name in guess], dtype=float) for k in (0, 1))
    places = np.stack(
        np.meshgrid(*(np.linspace(a, b, GRID + 2)[1:-1] for a, b in zip(low, high)), indexing="ij"), axis=-1
    )
    tried = [np.array([*guess.values()], dtype=float), *places.reshape(-1, len(guess))]
    best = min(tried, key=lambda x: float(np.square(residuals(x, few)).sum()))
    while few < count:
        options = {"bounds": (low, high), "x_scale": high - low, "diff_step": 1e-5}
        best = least_squares(lambda x, used=few: residuals(x, used), best, **options).x
        few = min(2 * few, count)
    return dict(zip(guess, map(float, best)))


def from_sweep(
    machine: Any,
    over: str,
    values: Sequence[float] | np.ndarray,
    responses: Sequence[float] | np.ndarray,
    unknown: Mapping[str, float],
    *,
    measure: str = "max_abs_q1",
    limits: Mapping[str, tuple[float, float]] | None = None,
    transient: float = SETTLED,
    confidence: float = 0.95,
) -> Calibration:
    """From steady responses over a parameter, measured in the order given: each from where the one before it has settled.

    Parameters
    ----------
    machine : Model
    over : str
        What was swept.
    values, responses : sequences of float
        In the machine's units.
    unknown, limits, confidence
        As for `from_impacts`.
    measure : str
        What was measured: of `orbits.attractors.sweep.measure_names`.
    transient : float
        Forcing periods after which a response is taken as steady.
    """
    from orbits.attractors import sweep

    places, heights = np.asarray(values, dtype=float), np.asarray(responses, dtype=float)
    if places.ndim != 1 or places.shape != heights.shape or not places.size:
        raise ParameterError(
            "the sweep needs two columns of equal length: the swept parameter and the response"
        )
    if not (np.all(np.isfinite(places)) and np.all(np.isfinite(heights))):
        raise ParameterError("the sweep has numbers that are not finite: leave those rows out")
    model = _with_amounts(machine, unknown)

    def residuals(guess: np.ndarray) -> np.ndarray:
        params = _vector(model, dict(zip(unknown, guess)))
        numbers: dict[str, Any] = dict(zip(model.parameter_names, (float(x) for x in params)))
        rows = sweep(model, over, places, transient=transient, nudge=0.0, **numbers)
        return np.array([row.measures[measure] for row in rows]) - heights

    return fit(residuals, unknown, _limits(model, unknown, limits), confidence)


def read_columns(path: str | Path, columns: int) -> np.ndarray:
    """A CSV of numbers, shape (n, columns); one line of names at its top is passed over.

    Raises
    ------
    ParameterError
        With the row that cannot be read.
    """
    import csv

    path = Path(path)
    try:
        lines = [
            row
            for row in csv.reader(path.read_text(encoding="utf-8").splitlines())
            if row and not row[0].startswith("#")
        ]
    except (OSError, UnicodeDecodeError):
        raise ParameterError(
            f"{path}: cannot be read; give a CSV with {columns} columns of numbers"
        ) from None
    found = []
    for number, row in enumerate(lines):
        try:
            found.append([float(cell) for cell in row[:columns]])
        except ValueError:
            if number == 0:
                continue
            raise ParameterError(
                f"{path}: row {number + 1} holds {', '.join(row[:columns])!r}, not {columns} numbers"
            ) from None
        if len(found[-1]) < columns:
            raise ParameterError(f"{path}: row {number + 1} has {len(row)} columns; {columns} are needed")
    if not found:
        raise ParameterError(f"{path}: there is no row of numbers; give {columns} columns")
    return np.array(found)


def _measured(times: Any) -> np.ndarray:
    measured = np.asarray(times, dtype=float)
    if measured.ndim != 1 or measured.size < 3:
        raise ParameterError("too few impacts: give the instants of three or more")
    if not np.all(np.isfinite(measured)):
        raise ParameterError("an instant is not finite: leave it out")
    if np.any(np.diff(measured) <= 0.0):
        raise ParameterError(
            f"the instants do not grow at number {int(np.argmin(np.diff(measured) > 0)) + 2}: sort them"
        )
    return measured


def _with_amounts(machine: Any, unknown: Mapping[str, float]) -> Any:
    """The machine told by what is to be estimated."""
    if not unknown:
        raise ParameterError(
            "nothing is unknown: name a parameter and a guess, for example restitution = 0.6"
        )
    told = getattr(machine, "told_by", None)
    for name in unknown:
        machine = told(name) if told is not None else machine
        machine.place_of(name)
        told = getattr(machine, "told_by", None)
    return machine


def _vector(model: Any, values: Mapping[str, float]) -> np.ndarray:
    with_ = getattr(model, "with_", None)
    return with_(**values).vector() if with_ is not None else model.vector(values)


def _limits(model: Any, unknown: Mapping[str, float], limits: Any) -> dict[str, tuple[float, float]]:
    usual = {"restitution": (0.01, 1.0), "friction": (0.0, 2.0)}
    return {
        name: tuple(limits[name])
        if limits and name in limits
        else usual.get(name, (0.2 * value, 5.0 * value))
        for name, value in unknown.items()
    }


def _slopes(residuals: Callable[[np.ndarray], np.ndarray], x: np.ndarray, span: np.ndarray) -> np.ndarray:
    """Central differences, shape (m, n), with steps of a millionth of the limits' span."""
    columns = []
    for j in range(x.size):
        step = np.zeros_like(x)
        step[j] = 1e-6 * span[j]
        columns.append((residuals(x + step) - residuals(x - step)) / (2.0 * step[j]))
    return np.column_stack(columns)
