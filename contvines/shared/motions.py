"""What many starts settle on, the kind of a motion that does not recur, and what modulated motions are called."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

SIGMAS = 3.0  # an exponent that many standard errors above zero is chaos
P = TypeVar("P", covariant=True)


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
