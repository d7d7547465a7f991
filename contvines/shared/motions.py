"""Motions on which simulated starts settle: their kinds and names, stability from multipliers, modulation, and low-discrepancy starts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from .numbers import ROUNDED

SIGMAS = 3.0  # standard errors above zero from which on a Lyapunov exponent means chaos
P = TypeVar("P", covariant=True)
# multipliers closer to the stability boundary than this factor times the nearest one's distance lie on it, too
SAME_DISTANCE = 10.0
GOLDEN = 60  # iterations for the root of g^(d+1) = g + 1


@dataclass(frozen=True, eq=False)
class Motion(Generic[P]):
    """A motion on which some starts settle.

    Attributes
    ----------
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, ``stopped``, or
        ``impossible`` (the start lies inside a wall).
    word : str
    periods : int
        Forcing periods (iterations of a map) after which it recurs.
    problem, u : Problem and float array, or None
        The motion as a solution that can be continued; None if it is none.
    exponent, error : float
        Largest Lyapunov exponent per period and its standard error; nan for motions that recur.
    state : float array (S,) or None
        A state on the motion, from which a simulation can continue.
    """

    kind: str
    word: str = ""
    periods: int = 0
    problem: P | None = field(default=None, repr=False)
    u: np.ndarray | None = field(default=None, repr=False)
    exponent: float = float("nan")
    error: float = float("nan")
    state: np.ndarray | None = field(default=None, repr=False)


def called(word: str, kind: str) -> str:
    """Return the name of a motion: its word, or its kind if it has none."""
    return word or ("no events" if kind == "periodic" else kind)


def wandering(exponent: float, error: float, roomy: bool) -> str:
    """Return the kind of a motion that does not recur: chaotic, quasi-periodic, or slow (still settling).

    Parameters
    ----------
    exponent, error : float
        Largest Lyapunov exponent and its standard error.
    roomy : bool
        Whether the dimension of the states allows quasi-periodic motions.
    """
    if exponent > SIGMAS * error:
        return "chaotic"
    return "quasi-periodic" if roomy and exponent > -SIGMAS * error else "slow"


def mean_of_blocks(values: np.ndarray, count: int) -> tuple[float, float]:
    """Return the mean of a time series, and its standard error from the scatter of the means of `count` blocks."""
    means = np.array([block.mean() for block in np.array_split(values, count)])
    return float(means.mean()), float(means.std(ddof=1) / math.sqrt(count))


BAND = ("modulated_low", "modulated_mean", "modulated_high")
"""Names of the measures lowest, mean and highest value of the largest response per forcing period."""
SILENT = "silent"
"""Name of the measure: share of the forcing periods without an impact."""
_NAMES = (("weak modulation", "strong modulation"), ("chaotic weak modulation", "chaotic strong modulation"))
MODULATIONS = frozenset(_NAMES[0] + _NAMES[1])
"""Names of modulated motions, used in place of a word."""
FEW = 0.01  # smallest share of periods without an impact in a strong modulation
STEADY = 0.001  # relative variation of the response below which it is steady; tables do not show less


def modulation_of(measures: Mapping[str, float], chaotic: bool = False) -> str:
    """Return the name of a motion's modulation.

    It is ``weak modulation``, or ``strong modulation`` if impacts stop and begin again (the strongly modulated response of vibro-impact
    absorbers), with ``chaotic`` before it if `chaotic`. It is empty for motions that recur, and for motions with a steady response.
    """
    low, mean, high = (measures.get(name, math.nan) for name in BAND)
    strong = is_strong(measures)
    if not math.isfinite(mean) or not (strong or high - low > STEADY * abs(high)):
        return ""
    return _NAMES[int(chaotic)][int(strong)]


def is_strong(measures: Mapping[str, float]) -> bool:
    """Whether a modulation is strong: impacts stop and begin again."""
    return FEW <= measures.get(SILENT, 0.0) < 1.0


def attracts(sizes: np.ndarray, boundary: float) -> bool | None:
    """Return whether all sizes are below a stability boundary; None if the largest lies on it within rounding.

    Parameters
    ----------
    sizes : ndarray
        Moduli of multipliers, or real parts of eigenvalues.
    boundary : float
        One, or zero.
    """
    largest = float(np.max(sizes, initial=-np.inf))
    return None if abs(largest - boundary) <= ROUNDED * boundary else largest < boundary


def onto_circle(multipliers: np.ndarray, near: float) -> np.ndarray:
    """Project the critical multipliers of a special point onto the unit circle: the nearest one, and those about as near.

    If the nearest one is further from the circle than `near`, none is changed: for example where an event of a virtual orbit grazes.
    """
    sizes = np.abs(multipliers)
    critical = _nearest(sizes - 1.0, near)
    return np.where(critical, multipliers / np.where(critical, sizes, 1.0), multipliers)


def onto_axis(eigenvalues: np.ndarray) -> np.ndarray:
    """Project the critical eigenvalues of a special point onto the imaginary axis; the nearest one always is."""
    return np.where(_nearest(np.real(eigenvalues), np.inf), 1j * np.imag(eigenvalues), eigenvalues)


def _nearest(gaps: np.ndarray, near: float) -> np.ndarray:
    gaps = np.nan_to_num(np.abs(gaps), nan=np.inf)
    nearest = float(gaps.min(initial=np.inf))
    return (gaps <= SAME_DISTANCE * nearest + ROUNDED) & np.isfinite(gaps) & (nearest <= near)


def marginal_text(multipliers: Iterable[complex], flow: bool = False) -> str:
    """Return the reason why stability is undecided, for multipliers (eigenvalues of a flow) of which some are on the boundary and none beyond.

    >>> marginal_text([1.0, 0.3]), marginal_text([-1.0]), marginal_text([0.0, -2.0], flow=True)
    ('marginal: a multiplier is 1', 'marginal: a multiplier is -1', 'marginal: an eigenvalue is 0')
    """
    values = np.asarray(list(multipliers), dtype=complex)
    critical = values[int(np.argmax(np.real(values) if flow else np.abs(values)))]
    if flow:
        reason = "an eigenvalue is 0" if critical.imag == 0.0 else "a pair of eigenvalues is imaginary"
    elif critical.imag == 0.0:
        reason = f"a multiplier is {'1' if critical.real > 0.0 else '-1'}"
    else:
        reason = "a pair of multipliers is on the unit circle"
    return f"marginal: {reason}"


def low_discrepancy(dimension: int, count: int, seed: int, first: int = 0) -> np.ndarray:
    """Return evenly distributed points of the unit cube, shape (count, dimension), by an additive recurrence.

    Parameters
    ----------
    dimension, count : int
    seed : int
        Random seed of a shift of all points (Cranley and Patterson 1976); each seed gives another, equally even, set.
    first : int
        Number of the first point; a later call can continue the sequence.

    Notes
    -----
    Point n is ``shift + n (1/g, 1/g^2, ...) mod 1`` with ``g^(d+1) = g + 1`` (M. Roberts 2018; in one dimension the golden
    ratio, whose gaps have at most three lengths for every count: the three-distance theorem). The import of `scipy.stats` for Sobol's
    points would take longer than many diagrams.
    """
    root = 2.0
    for _ in range(GOLDEN):
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    shift = np.random.default_rng(seed).random(dimension)
    steps = root ** -np.arange(1.0, dimension + 1)
    return (shift + np.arange(first, first + count)[:, None] * steps) % 1.0
