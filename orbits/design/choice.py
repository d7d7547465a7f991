"""Optimisation: the best value of an outcome over one or two parameters, for one machine or in the worst case over uncertain parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from orbits.arguments import SMALLEST
from orbits.machines.base import ParameterError
from orbits.settings import DESIGNING

Evaluate = Callable[[dict[str, float]], Mapping[str, float]]


@dataclass(frozen=True, eq=False)
class Choice:
    """The best parameters and their outcomes.

    Attributes
    ----------
    values : dict
        The chosen parameters.
    outcome : float
        The outcome of the choice (with tolerances: the worst one over the samples, or the quantile).
    others : dict
        All other outcomes of the choice (with tolerances: the median of the finite ones; nan if there are none).
    tried : list of (dict, float)
        Every evaluated choice with its outcome; nan if it has none.
    bracket : dict
        Name -> the neighbouring values among the evaluated choices, below and above.
    """

    values: dict[str, float]
    outcome: float
    others: dict[str, float] = field(default_factory=dict)
    tried: list[tuple[dict[str, float], float]] = field(default_factory=list, repr=False)
    bracket: dict[str, tuple[float, float]] = field(default_factory=dict)


def best(
    evaluate: Evaluate,
    outcome: str,
    over: Mapping[str, tuple[float, float]],
    *,
    largest: bool = False,
    tolerances: Sequence[Mapping[str, float]] = ({},),
    quantile: float | None = None,
    grid: int = 9,
    known: Sequence[tuple[Mapping[str, float], float]] = (),
) -> Choice:
    """Find the choice of parameters with the lowest (or largest) outcome.

    A grid is evaluated first, because an outcome over coexisting motions has kinks and steps. Then the best grid point is
    refined between its neighbours (`scipy.optimize`: Brent's bounded method over one parameter, Nelder and Mead's
    simplex over two). The best of all evaluated choices is returned.

    Parameters
    ----------
    evaluate : callable
        Maps parameter values to all outcomes of this machine, both by name. A choice with a ValueError or an outcome that is not finite is never the best.
    outcome : str
        Name of the outcome to be optimised.
    over : mapping
        One or two parameters, each with its interval (low, high).
    largest : bool
        Maximise instead of minimise.
    tolerances : sequence of mapping
        Samples of uncertain parameters, name -> value; the outcome of a choice is the worst over the samples.
    quantile : float, optional
        Take this quantile over the samples instead of the worst: 0.95 leaves out the worst twentieth.
    grid : int
        Values per parameter on the grid.
    known : sequence of (mapping, float)
        Choices whose outcomes are known already (from a survey); if there are any, no grid is evaluated.

    Returns
    -------
    Choice

    Raises
    ------
    ParameterError
        If an argument is out of range, the outcome is unknown, or no evaluated choice has a finite outcome.
    """
    _check(over, quantile, grid)
    names = list(over)
    sign = -1.0 if largest else 1.0
    tried: dict[tuple[float, ...], float] = {}
    full: dict[tuple[float, ...], dict[str, float]] = {}

    def value(point: Sequence[float] | np.ndarray) -> float:
        key = tuple(min(max(float(x), low), high) for x, (low, high) in zip(point, over.values()))
        if key not in tried:
            tried[key], full[key] = _judged(
                evaluate, dict(zip(names, key)), outcome, tolerances, quantile, sign
            )
        return tried[key]

    for point, number in known:
        tried[tuple(float(point[name]) for name in names)] = (
            sign * number if math.isfinite(number) else math.inf
        )
    if not tried:
        places = [np.linspace(low, high, grid) for low, high in over.values()]
        for point in np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, len(names)):
            value(point)
    if not any(math.isfinite(number) for number in tried.values()):
        raise ParameterError(
            f"no machine that was tried has a number for {outcome}; widen the intervals or change the machine"
        )
    start = min(tried, key=lambda key: tried[key])
    _refine(value, start, list(tried), list(over.values()))
    chosen = min(tried, key=lambda key: tried[key])
    if chosen not in full:
        _, full[chosen] = _judged(evaluate, dict(zip(names, chosen)), outcome, tolerances, quantile, sign)
    others = {name: number for name, number in full[chosen].items() if name != outcome}
    listed = [
        (dict(zip(names, key)), sign * number if math.isfinite(number) else math.nan)
        for key, number in tried.items()
    ]
    bracket = {
        name: _neighbours(chosen[i], sorted({key[i] for key in tried})) for i, name in enumerate(names)
    }
    return Choice(dict(zip(names, chosen)), sign * tried[chosen], others, listed, bracket)


def _check(over: Mapping[str, tuple[float, float]], quantile: float | None, grid: int) -> None:
    if not 1 <= len(over) <= 2:
        raise ParameterError(f"over has {len(over)} parameters: give one or two")
    for name, (low, high) in over.items():
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise ParameterError(f"{name} within [{low:g}, {high:g}]: give low < high")
    if quantile is not None and not 0.0 < quantile <= 1.0:
        raise ParameterError(
            f"quantile = {quantile!r}: give a number above 0 and at most 1, for example 0.95"
        )
    if grid < 3:
        raise ParameterError(f"grid = {grid}: give 3 or more values per parameter")


def _judged(
    evaluate: Evaluate,
    point: dict[str, float],
    outcome: str,
    tolerances: Sequence[Mapping[str, float]],
    quantile: float | None,
    sign: float,
) -> tuple[float, dict[str, float]]:
    """Return the outcome of a choice over all samples, with the sign that makes the lowest the best, and the medians of all outcomes; (inf, {}) if a sample fails."""
    rows = []
    for drawn in tolerances:
        try:
            rows.append(dict(evaluate({**point, **drawn})))
        except ValueError:
            return math.inf, {}
        if outcome not in rows[-1]:
            raise ParameterError(f"outcome = {outcome!r} is unknown; there are {', '.join(rows[-1])}")
    numbers = np.array([sign * row[outcome] for row in rows])
    if not np.all(np.isfinite(numbers)):
        return math.inf, {}
    number = float(numbers.max() if quantile is None else np.quantile(numbers, quantile))
    return number, {name: _middle([row[name] for row in rows]) for name in rows[0]}


def _middle(numbers: Sequence[float]) -> float:
    """Median of the finite numbers; nan if there are none."""
    finite = [number for number in numbers if math.isfinite(number)]
    return float(np.median(finite)) if finite else math.nan


def _refine(
    value: Callable[[Sequence[float]], float],
    start: tuple[float, ...],
    tried: list[tuple[float, ...]],
    over: list[tuple[float, float]],
) -> None:
    """Optimise `value` between the neighbours of `start`; the results are those that `value` stores."""
    from scipy.optimize import minimize, minimize_scalar

    brackets: list[Any] = [_neighbours(x, sorted({key[i] for key in tried})) for i, x in enumerate(start)]
    if len(over) == 1:
        low, high = brackets[0]
        minimize_scalar(
            lambda x: value([x]),
            bounds=(low, high),
            method="bounded",
            options={"xatol": DESIGNING.accuracy * (over[0][1] - over[0][0])},
        )
        return
    sizes = np.array([max(b[1] - b[0], SMALLEST) for b in brackets])
    simplex = np.array([[0.0, 0.0], [0.25, 0.0], [0.0, 0.25]])
    minimize(
        lambda x: value(np.asarray(start) + x * sizes),
        np.zeros(2),
        method="Nelder-Mead",
        options={
            "initial_simplex": simplex,
            "xatol": DESIGNING.accuracy * 4.0,
            "fatol": DESIGNING.level,
            "maxfev": 60,
        },
    )


def _neighbours(x: float, values: list[float]) -> tuple[float, float]:
    """The values next to x, below and above; x itself at an end."""
    place = values.index(x)
    return values[max(place - 1, 0)], values[min(place + 1, len(values) - 1)]
