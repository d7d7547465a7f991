"""Symmetry breaking: a pair of solutions of less symmetry leaves, where a multiplier of the half map passes -1."""

from __future__ import annotations

from functools import partial

from ..kind import Kind
from ..multiplier_tests import flips

KIND = Kind(
    "symmetry-breaking",
    "SB",
    text="symmetry breaking",
    marker="D",
    filled=False,
    tests=partial(flips, kind="symmetry-breaking"),
    locus="flip",
    leaves="doubled",
    without="a pair of solutions of less symmetry leaves here; this problem has no equations for it",
)
