"""What modulated motions are called, and the names of their numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping

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
