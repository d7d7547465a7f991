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


def modulation_of(measures: Mapping[str, float], chaotic: bool = False) -> str:
    """``weak modulation``, ``strong modulation`` where impacts stop and begin again (the strongly modulated response of vibro-impact
    absorbers), either with ``chaotic`` before it; empty for a motion without a band, such as one that recurs."""
    if not math.isfinite(measures.get(BAND[1], math.nan)):
        return ""
    return _NAMES[int(chaotic)][int(is_strong(measures))]


def is_strong(measures: Mapping[str, float]) -> bool:
    """Whether impacts stop and begin again."""
    return FEW <= measures.get(SILENT, 0.0) < 1.0
