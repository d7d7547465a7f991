"""Multipliers that are told to grow without bound towards a border: followed in many digits, where nodes in doubles come no nearer."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from tests.orbits.fuzz.many_digits import DIGITS, Exact, Motion, solved

LARGE = 1e14
FASTER = 100.0  # the border is approached in steps after which multipliers are so many times as large ...
GROWS = 10.0  # ... and at least so many times
NEAR = 1e-8  # the border's motion is so near to those beside it; and in the parameter, relative ...
PLACE = 1e-13  # ... beside the border's told error


def grow_without_bound(one: Any, nearer: Any, error: float) -> bool:
    """Whether multipliers of two orbits of a branch beside a border go on to grow, up to the border, until they are `LARGE`.

    Their inverses tend to zero as the distance or its square root does; so the branch is followed, in many digits, to where their line
    through the last two orbits all but vanishes.

    Parameters
    ----------
    one, nearer : Orbit
        The second one is at the border but for rounding ...
    error : float
        ... and for what the border's place is told to be wrong by.
    """
    with mp.workdps(DIGITS):
        motion = Motion(nearer)
        value = motion.given[motion.parameter]
        try:
            before, here = (
                solved(motion, orbit.nodes, Motion(orbit).given[motion.parameter]) for orbit in (one, nearer)
            )
            while before is not None and here is not None and _growth(here) < LARGE:
                before, here = here, _nearer(motion, before, here)
        except (ArithmeticError, ValueError):
            return False
        if before is None or here is None:
            return False
        moved = max(abs(x - y) for row, own in zip(here.nodes, nearer.nodes) for x, y in zip(row, own))
        return bool(moved < NEAR and abs(here.value - value) < PLACE * max(1, abs(value)) + error)


def _nearer(motion: Motion, before: Exact, here: Exact) -> Exact | None:
    """An orbit of multipliers that are `FASTER` times as large, if the line says where; None if they are not even `GROWS` times so."""
    one, other = 1 / mp.mpf(_growth(before)), 1 / mp.mpf(_growth(here))
    if not other < one:
        return None
    share = (other - other / FASTER) / (one - other)
    guess = [[x + share * (x - y) for x, y in zip(*rows)] for rows in zip(here.nodes, before.nodes)]
    found = solved(motion, guess, here.value + share * (here.value - before.value))
    return found if found is not None and _growth(found) > GROWS * _growth(here) else None


def _growth(found: Exact) -> float:
    return float(np.abs(found.multipliers).max())
