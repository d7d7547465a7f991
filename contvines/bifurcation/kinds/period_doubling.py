"""Period doubling: a real multiplier passes -1, and a motion of twice the period leaves."""

from __future__ import annotations

from functools import partial

from ..kind import Kind
from ..multiplier_tests import flips

KIND = Kind(
    "period-doubling",
    "PD",
    text="period doubling",
    marker="^",
    filled=False,
    tests=partial(flips, kind="period-doubling"),
    locus="flip",
    leaves="doubled",
    without="a solution of twice the period leaves here; this problem has no equations for it",
)
