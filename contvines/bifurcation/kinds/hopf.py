"""Hopf: a complex pair of eigenvalues passes the imaginary axis, and a branch of cycles leaves."""

from __future__ import annotations

from functools import partial

from ..kind import Kind
from ..multiplier_tests import pairs
from ..pair_normal_form import classify

KIND = Kind(
    "hopf",
    "HB",
    text="Hopf",
    marker="h",
    filled=False,
    tests=partial(pairs, spectrum="flow"),
    classify=classify,
    locus="pair",
    leaves="cycles",
    nothing="a branch of limit cycles leaves a Hopf point; this problem has equations for equilibria only",
)
