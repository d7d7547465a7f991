"""What many starts settle on: where they start, whether it attracts, the kind of a motion that does not recur, and what modulated motions are called."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from .numbers import ROUNDED

SIGMAS = 3.0  # an exponent that many standard errors above zero is chaos
P = TypeVar("P", covariant=True)
KNOWN = 10.0  # times the distance at which the nearest was computed: how well the others are known that are to be on the boundary, too
GOLDEN = 60  # steps to the root


@dataclass(frozen=True, eq=False)
class Motion(Generic[P]):
    """One motion that some starts settle on.

    Attributes
    ----------
    kind : str
        ``periodic``, ``sliding``, ``stuck``, ``chatter``, ``chaotic``, ``quasi-periodic``, ``slow``, ``escaped``, ``stopped``, or
        ``impossible`` (the start lies inside a wall).
    word : str
    periods : int
    problem, u : Problem and float array, or None
        The motion as a solution that can be continued, where it is one.
    exponent, error : float
        Largest Lyapunov exponent per period and its standard error; nan for motions that recur.
    state : float array (S,) or None
        A state on it, from which a simulation goes on.
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
    """What a motion is called: its word, or what kind of motion has none."""
    return word or ("no events" if kind == "periodic" else kind)


def wandering(exponent: float, error: float, roomy: bool) -> str:
    """The kind of a motion that does not recur, from its largest Lyapunov exponent and the standard error of it.

    Parameters
    ----------
    exponent, error : float
    roomy : bool
        Whether the states have room for two incommensurate frequencies.
    """
    if exponent > SIGMAS * error:
        return "chaotic"
    return "quasi-periodic" if roomy and exponent > -SIGMAS * error else "slow"


def mean_of_blocks(values: np.ndarray, count: int) -> tuple[float, float]:
    """Mean of values that follow each other, and its standard error from the scatter of so many blocks."""
    means = np.array([block.mean() for block in np.array_split(values, count)])
    return float(means.mean()), float(means.std(ddof=1) / math.sqrt(count))


BAND = ("modulated_low", "modulated_mean", "modulated_high")
"""Measures: the lowest, mean and highest of the largest responses in each forcing period."""
SILENT = "silent"
"""A measure: the share of the forcing periods without an impact."""
_NAMES = (("weak modulation", "strong modulation"), ("chaotic weak modulation", "chaotic strong modulation"))
MODULATIONS = frozenset(_NAMES[0] + _NAMES[1])
"""What a modulated motion may be called, where others have a word."""
FEW = 0.01  # of the periods without an impact: fewer do not make a modulation strong
STEADY = 0.001  # of the largest response: one that varies by less, which no table shows, is steady


def modulation_of(measures: Mapping[str, float], chaotic: bool = False) -> str:
    """``weak modulation``, ``strong modulation`` where impacts stop and begin again (the strongly modulated response of vibro-impact
    absorbers), either with ``chaotic`` before it; empty for a motion without a band, such as one that recurs, and for one whose response is steady while
    the absorber wanders."""
    low, mean, high = (measures.get(name, math.nan) for name in BAND)
    strong = is_strong(measures)
    if not math.isfinite(mean) or not (strong or high - low > STEADY * abs(high)):
        return ""
    return _NAMES[int(chaotic)][int(strong)]


def is_strong(measures: Mapping[str, float]) -> bool:
    """Whether impacts stop and begin again."""
    return FEW <= measures.get(SILENT, 0.0) < 1.0


def attracts(sizes: np.ndarray, boundary: float) -> bool | None:
    """Whether all are below the boundary; None where the largest is on it but for rounding.

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
    """Multipliers of a special point, those put on the unit circle that are there by definition: the nearest, and what is not told from it.

    None is, if the nearest is further from the circle than `near`: as where an event of a virtual orbit grazes.
    """
    sizes = np.abs(multipliers)
    there = _nearest(sizes - 1.0, near)
    return np.where(there, multipliers / np.where(there, sizes, 1.0), multipliers)


def onto_axis(eigenvalues: np.ndarray) -> np.ndarray:
    """The same for eigenvalues and the imaginary axis, on which one always is."""
    return np.where(_nearest(np.real(eigenvalues), np.inf), 1j * np.imag(eigenvalues), eigenvalues)


def _nearest(gaps: np.ndarray, near: float) -> np.ndarray:
    gaps = np.nan_to_num(np.abs(gaps), nan=np.inf)
    nearest = float(gaps.min(initial=np.inf))
    return (gaps <= KNOWN * nearest + ROUNDED) & np.isfinite(gaps) & (nearest <= near)


def marginal_text(multipliers: Iterable[complex], flow: bool = False) -> str:
    """Why stability is undecided, from multipliers of which some are on the boundary, and none beyond.

    >>> marginal_text([1.0, 0.3]), marginal_text([-1.0]), marginal_text([0.0, -2.0], flow=True)
    ('marginal: a multiplier is 1', 'marginal: a multiplier is -1', 'marginal: an eigenvalue is 0')
    """
    values = np.asarray(list(multipliers), dtype=complex)
    critical = values[int(np.argmax(np.real(values) if flow else np.abs(values)))]
    if flow:
        what = "an eigenvalue is 0" if critical.imag == 0.0 else "a pair of eigenvalues is imaginary"
    elif critical.imag == 0.0:
        what = f"a multiplier is {'1' if critical.real > 0.0 else '-1'}"
    else:
        what = "a pair of multipliers is on the unit circle"
    return f"marginal: {what}"


def low_discrepancy(dimension: int, count: int, seed: int, first: int = 0) -> np.ndarray:
    """Points of the unit cube, shape (count, dimension): an additive recurrence, shifted by the seed.

    Parameters
    ----------
    dimension, count : int
    seed : int
        Of the shift (Cranley and Patterson 1976); each seed is another, equally even, set of points.
    first : int
        Number of the first point, so that draws can go on.

    Notes
    -----
    Point n is ``shift + n (1/g, 1/g^2, ...) mod 1`` with ``g^(d+1) = g + 1`` (M. Roberts 2018; in one dimension the golden
    ratio, whose gaps have at most three lengths for every count: the three-distance theorem). Sobol's points of `scipy.stats` would take
    longer to import than many a diagram takes.
    """
    root = 2.0
    for _ in range(GOLDEN):
        root = (1.0 + root) ** (1.0 / (dimension + 1))
    shift = np.random.default_rng(seed).random(dimension)
    steps = root ** -np.arange(1.0, dimension + 1)
    return (shift + np.arange(first, first + count)[:, None] * steps) % 1.0
