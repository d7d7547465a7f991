"""Calibration: estimate restitution, friction and other parameters from measured impact times or from a measured sweep.

Simulated motions are fitted to the data by least squares. Confidence intervals follow from the Jacobian of the residuals at the estimate
and Student's t distribution. Scatter that the model does not describe enlarges the residuals, and so the intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import did_you_mean
from orbits.machines.base import ParameterError
from orbits.machines.parameters import along
from orbits.settings import DESIGNING

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from orbits.machines.varying import Varying
    from orbits.simulation.runs import Start


GRID = 900  # most grid points of the search for a guess
CANDIDATES = 8  # grid points from which least squares begins
STARTS = 5  # random starts of a sweep, besides rest
TRIED = 6  # random parameter values that are combined with these starts
# largest scatter, relative to the mean time between impacts; above it the fit is refused
LARGEST_SCATTER = 0.1
HALVINGS = 40  # bisections that move a default limit to the last possible value of a parameter
SETTLED = 400  # forcing periods that are left out before a steady response is measured
WIDEST = 0.1  # largest step of finite differences, relative to the distance of the limits
AGREEING = 0.3  # largest relative difference between slopes with one step and with four times that step; below it data count as smooth


def from_impacts(
    machine: Varying,
    times: Sequence[float] | np.ndarray,
    unknown: Mapping[str, float],
    *,
    start: Mapping[str, float] | None = None,
    limits: Mapping[str, Sequence[float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    confidence: float = 0.95,
) -> Calibration:
    """Estimate parameters from the instants of successive impacts.

    The time at which the measurement begins need not be known: measured and simulated times are compared after removal of their mean difference.

    Parameters
    ----------
    machine : Model
    times : sequence of float
        Instants of impacts, ascending; in seconds for a physical machine, else in 1/omega_0.
    unknown : mapping
        Parameter name -> guess; for a physical machine in its units.
    start : mapping, optional
        State in which the measurement begins (see `orbits.simulation.simulate`); default: rest.
    limits : mapping, optional
        Parameter name -> (low, high); a parameter without an entry has default limits.
    fixed : mapping, optional
        Values of parameters that are no fields of the machine (`amplitude`).
    confidence : float
        Confidence level of the intervals.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If the times are too few, not finite or not ascending, or if the fitted model scatters too much about the data.
    """
    from orbits.simulation import simulate

    measured = _measured(times)
    model = _with_amounts(machine, unknown)
    bounds = _limits(model, unknown, limits)
    elapsed = measured - measured[0]
    count = measured.size

    def residuals(values: np.ndarray, used: int = count) -> np.ndarray:
        params = _vector(model, dict(zip(unknown, values)), fixed)
        numbers: dict[str, Any] = model.named(params)
        instants = np.empty(0)
        # few events first, because most motions have few turns between impacts
        for events in (3 * used + 20, 40 * used + 400):
            if instants.size < used:
                instants = simulate(model, start, events=events, **numbers).impact_times[:used]
        if instants.size < used:
            return np.full(used, 1000.0 * float(elapsed[-1]))
        late = (instants - instants[0]) - elapsed[:used]
        return late - late.mean()

    found = fit(residuals, _improved(residuals, unknown, bounds, count), bounds, confidence, spent=1)
    between = float(elapsed[-1]) / (count - 1)
    if found.scatter > LARGEST_SCATTER * between:
        raise ParameterError(
            f"no {', '.join(unknown)} make{'s' if len(unknown) == 1 else ''} the model follow these impacts: at best they scatter by "
            f"{found.scatter:.3g}, with {between:.3g} from one to the next. Is the machine the measured one, does the run begin as the "
            "measurement did, is an impact missing? Fewer impacts, other limits or one more unknown parameter may help"
        )
    return replace(found, between=between)


def _improved(
    residuals: Callable[..., np.ndarray],
    guess: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]],
    count: int,
) -> dict[str, float]:
    """Improve a guess until it fits all impacts.

    With a wrong guess, simulated impacts soon lose their order relative to the measured ones, and the sum of squares over many impacts has
    many minima. So a grid is evaluated with the first few impacts only. From its lowest local minima (and the given guess) least squares
    is repeated with twice as many impacts each time. The candidate with the smallest sum over all impacts is returned.
    """
    from scipy.optimize import least_squares

    few = min(count, 2 * len(guess) + 4)
    low, high = (np.array([limits[name][k] for name in guess], dtype=float) for k in (0, 1))
    side = max(int(GRID ** (1.0 / len(guess))), 3)
    # a parameter whose lower limit is 0 has more grid points near 0
    shares = [np.linspace(0.0, 1.0, side + 2)[1:-1] ** (2.0 if a == 0.0 else 1.0) for a in low]
    places = np.stack(
        np.meshgrid(*(a + (b - a) * x for a, b, x in zip(low, high, shares)), indexing="ij"), axis=-1
    )
    sums = np.apply_along_axis(lambda x: float(np.square(residuals(x, few)).sum()), -1, places)
    tried = [np.array([*guess.values()], dtype=float), *_lowest(sums, places, CANDIDATES)]
    options: dict[str, Any] = {
        "bounds": (low, high),
        "x_scale": high - low,
        "diff_step": DESIGNING.difference,
    }

    def followed(x: np.ndarray) -> tuple[float, np.ndarray]:
        used = few
        while True:
            x = least_squares(lambda y, used=used: residuals(y, used), x, **options).x
            if used == count:
                return float(np.square(residuals(x, count)).sum()), x
            used = min(2 * used, count)

    best = min((followed(x) for x in tried), key=lambda pair: pair[0])[1]
    return dict(zip(guess, map(float, best)))


def _lowest(sums: np.ndarray, places: np.ndarray, most: int) -> list[np.ndarray]:
    """Return at most `most` local minima of `sums` on a grid, as points of `places`, the lowest first."""
    from scipy.ndimage import minimum_filter

    least = np.argwhere((sums <= minimum_filter(sums, 3, mode="nearest")) & np.isfinite(sums))
    order = np.argsort([sums[tuple(place)] for place in least], kind="stable")
    return [places[tuple(least[k])] for k in order[:most]]


def from_sweep(
    machine: Varying,
    over: str,
    values: Sequence[float] | np.ndarray,
    responses: Sequence[float] | np.ndarray,
    unknown: Mapping[str, float],
    *,
    measure: str = "max_abs_q1",
    limits: Mapping[str, Sequence[float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    transient: float = SETTLED,
    confidence: float = 0.95,
) -> Calibration:
    """Estimate parameters from the steady responses of a measured sweep.

    The simulated sweep visits the values in the given order; each motion begins in the state in which the one before has settled.
    Several motions may coexist, so the first one is simulated from rest and from a few random states; the start whose sweep is closest to
    the data is used.

    Parameters
    ----------
    machine : Model
    over : str
        The swept parameter.
    values, responses : sequences of float
        Values of the parameter and measured responses, in the machine's units, in the order of measurement.
    unknown, limits, fixed, confidence
        As for `from_impacts`.
    measure : str
        The measured quantity, one of `orbits.attractors.attractor.measure_names`.
    transient : float
        Forcing periods after which a response counts as steady.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If the columns differ in length or have numbers that are not finite, the sweep has no such measure, or the data do not determine the
        parameters.
    """
    from orbits.attractors import sweep
    from orbits.attractors.attractor import measure_names

    places, heights = np.asarray(values, dtype=float), np.asarray(responses, dtype=float)
    if places.ndim != 1 or places.shape != heights.shape or not places.size:
        raise ParameterError(
            "the sweep needs two columns of equal length: the swept parameter and the response"
        )
    if not (np.all(np.isfinite(places)) and np.all(np.isfinite(heights))):
        raise ParameterError("the sweep has numbers that are not finite: leave those rows out")
    model = _with_amounts(machine, unknown)
    if measure not in (names := measure_names(model)):
        raise ParameterError(
            f"measure = {measure!r} is no measure of a sweep of {model.name!r}{did_you_mean(measure, names)}: choose from {', '.join(names)}"
        )

    def residuals(guess: np.ndarray, start: Start = None) -> np.ndarray:
        params = _vector(model, dict(zip(unknown, guess)), fixed)
        numbers: dict[str, Any] = model.named(params)
        rows = sweep(model, over, places, start=start, transient=transient, nudge=0.0, **numbers)
        return np.array([row.measures[measure] for row in rows]) - heights

    bounds = _limits(model, unknown, limits)
    first_guess = np.array([*unknown.values()], dtype=float)
    generator = np.random.default_rng(20)
    params = _vector(model, unknown, fixed)
    starts = [None, *(model.random_start(params, generator) for _ in range(STARTS))]
    low, high = np.array([*bounds.values()]).T
    tried = [first_guess, *(low + generator.random((TRIED, first_guess.size)) * (high - low))]
    pairs = [(start, x) for x in tried for start in starts]
    start, x = min(pairs, key=lambda pair: float(np.square(residuals(pair[1], pair[0])).sum()))
    return fit(lambda y: residuals(y, start), dict(zip(unknown, map(float, x))), bounds, confidence)


def _measured(times: ArrayLike) -> np.ndarray:
    """Return the measured instants as an array, or raise a `ParameterError` if they cannot be used."""
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


def _with_amounts(machine: Varying, unknown: Mapping[str, float]) -> Varying:
    """Return the machine in a form that has all unknown parameters as fields (a physical machine may be given by different ones)."""
    if not unknown:
        raise ParameterError(
            "nothing is unknown: name a parameter and a guess, for example restitution = 0.6"
        )
    given_by = getattr(machine, "given_by", None)
    for name in unknown:
        machine = given_by(name) if given_by is not None else machine
        machine.place_of(name)
        given_by = getattr(machine, "given_by", None)
    return machine


def _vector(model: Varying, values: Mapping[str, float], fixed: Mapping[str, float] | None) -> np.ndarray:
    """Return the parameter vector with the `fixed` values and the estimated `values`."""
    params = model.vector(fixed)
    for name, value in values.items():
        params = along(model.path(name, params), params, float(value))
    return params


def _limits(
    model: Varying, unknown: Mapping[str, float], limits: Mapping[str, Sequence[float]] | None
) -> dict[str, tuple[float, float]]:
    """Return limits of every unknown parameter: the given ones, or by default 0.2 to 5 times the guess."""
    defaults = {"restitution": (0.01, 1.0), "friction": (0.0, 2.0)}
    found: dict[str, tuple[float, float]] = {}
    for name, value in unknown.items():
        if name in (limits or {}):
            low, high = (limits or {})[name]
        elif name in defaults:
            low, high = defaults[name]
        elif value:
            low, high = sorted(_possible(model, name, value, times * value) for times in (0.2, 5.0))
        else:
            raise ParameterError(f"{name} = 0 is no guess; give another one, or limits of the estimate")
        if not low <= value <= high:
            raise ParameterError(
                f"{name} = {value:g}, where the search begins, lies outside the limits {low:g} and {high:g}"
            )
        found[name] = (low, high)
    return found


def _possible(model: Varying, name: str, value: float, end: float) -> float:
    """Return `end`, or the last possible value of the parameter on the way from `value` to it."""

    def can_be(number: float) -> bool:
        try:
            model.check_value(name, number)
        except ParameterError:
            return False
        return True

    if can_be(end):
        return end
    inside, outside = value, end
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if can_be(middle) else (inside, middle)
    return inside


@dataclass(frozen=True, eq=False)
class Calibration:
    """Estimated parameters.

    Attributes
    ----------
    values : dict
        Name -> estimate.
    intervals : dict
        Name -> (low, high) of the confidence interval, cut off at the limits.
    confidence : float
        Confidence level of the intervals.
    scatter : float
        Standard deviation of the residuals, in the unit of the data.
    residuals : float array
        Model minus data at the estimate.
    correlation : float array (n, n)
        Correlation of the estimates; near 1 or -1 the data do not distinguish two parameters.
    between : float
        Mean time between impacts, in the unit of the data; nan for a sweep.
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
    """Fit parameters by least squares and compute confidence intervals.

    Parameters
    ----------
    residuals : callable
        Maps parameter values (n,) to the differences between model and data, shape (m,).
    guess : mapping
        Name -> value at which the search begins.
    limits : mapping
        Name -> (low, high).
    confidence : float
        Confidence level of the intervals.
    spent : int
        Degrees of freedom that quantities other than the parameters use up, for example a mean that was subtracted.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If there are no more data than parameters, or the data do not depend on one of the parameters.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t

    names = list(guess)
    start = np.array([float(guess[name]) for name in names])
    low, high = (np.array([limits[name][k] for name in names], dtype=float) for k in (0, 1))
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
    """Jacobian of the residuals with respect to the parameters by central differences, shape (m, n).

    Small steps serve where the data are smooth. But responses jump where the motion changes, and jitter where the motion does not settle;
    there the slope over a small step is meaningless. So a step is compared with one four times as long; while the slopes
    disagree, the step grows, at most until it changes the residuals by `scatter`.
    """

    def slope_of(j: int, step: float) -> np.ndarray:
        """Central difference with respect to parameter j; one-sided at a limit."""
        below, above = x.copy(), x.copy()
        below[j], above[j] = max(x[j] - step, low[j]), min(x[j] + step, high[j])
        return (residuals(above) - residuals(below)) / (above[j] - below[j])

    columns = []
    for j in range(x.size):
        step = DESIGNING.effect * (high[j] - low[j])
        slope = slope_of(j, step)
        while step < WIDEST * (high[j] - low[j]) and np.linalg.norm(slope) * step > scatter:
            wider = slope_of(j, 4.0 * step)
            if np.linalg.norm(wider - slope) < AGREEING * np.linalg.norm(slope):
                break
            step, slope = 4.0 * step, wider
        columns.append(slope)
    return np.column_stack(columns)
