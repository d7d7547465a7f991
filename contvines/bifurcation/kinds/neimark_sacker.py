"""Neimark-Sacker: a complex pair of multipliers passes the unit circle, and an invariant circle leaves."""

from __future__ import annotations

from functools import partial

from ..kind import Kind
from ..multiplier_tests import pairs
from ..pair_normal_form import classify

KIND = Kind(
    "neimark-sacker",
    "NS",
    text="Neimark-Sacker",
    marker="p",
    filled=False,
    tests=partial(pairs, spectrum="map"),
    classify=classify,
    locus="pair",
    leaves="circle",
    nothing="an invariant circle leaves a Neimark-Sacker point, no branch of cycles; its circles() follow it",
)
