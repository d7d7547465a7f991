"""Branches followed in many digits towards a special point, where nodes in doubles come no nearer."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from tools.fuzz.many_digits import DIGITS, Exact, Motion, solved

LARGE = 1e14
FASTER = 100.0  # the border is approached in steps after which multipliers are so many times as large ...
GROWS = 10.0  # ... and at least so many times
NEAR = 1e-8  # the border's motion is so near to those beside it; and in the parameter, relative ...
PLACE = 1e-13  # ... beside the border's told error
THERE = 1e-9  # nodes that are no further from those of a special point are there ...
KNOWN = 1e-5  # ... or as near as that, where rounding, or the told error of the point's place, leaves it open
TENTH, HALF = 0.1, 0.5  # of the distance that each step is to leave, and leaves at most


def grow_without_bound(one: Any, nearer: Any, error: float) -> bool:
    """Whether multipliers of two orbits of a branch beside a border go on to grow, up to the border, until they are `LARGE`.

    Their inverses tend to zero as the distance or its square root does, and pass it: the multiplier that grows comes back from infinity
    with the other sign. So the branch is followed, in many digits, to where the line through the last two orbits all but vanishes.

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
        # the motion changes by so much where the border may be
        near = max(NEAR, min(KNOWN, here.steepness * error))
        return bool(moved < near and abs(here.value - value) < PLACE * max(1.0, abs(float(value))) + error)


def _nearer(motion: Motion, before: Exact, here: Exact) -> Exact | None:
    """An orbit of multipliers that are `FASTER` times as large, if the line says where; None if they are not even `GROWS` times so.

    On the other side of infinity they may be smaller: so far the line had been bent.
    """
    one, other = 1 / mp.mpf(_largest(before)), 1 / mp.mpf(_largest(here))
    if one == other:
        return None
    found = _further(motion, before, here, (other - other / FASTER) / (one - other))
    if found is None:
        return None
    grown = _growth(found) > GROWS * _growth(here)
    passed = _largest(found) * _largest(here) < 0.0 and _growth(found) > _growth(here)
    return found if grown or passed else None


def comes_to(one: Any, nearer: Any, end: Any, error: float = 0.0) -> bool:
    """Whether a branch through two orbits goes on to the nodes of a third one: along the line through the last two, solved each time.

    Beside a branch point the equations are the more singular the nearer it is: what solves them in doubles stops short of it, or is of
    the other branch. Of that, of repeated shorter orbits, the first two must not be.
    """
    if not nearer.impacts:
        return False
    with mp.workdps(DIGITS):
        motion = Motion(nearer)
        value = Motion(end).given[motion.parameter]

        def off(found: Exact) -> Any:
            return max(abs(x - y) for row, own in zip(found.nodes, end.nodes) for x, y in zip(row, own))

        try:
            before, here = (
                solved(motion, orbit.nodes, Motion(orbit).given[motion.parameter]) for orbit in (one, nearer)
            )
            while before is not None and here is not None and off(here) > max(THERE, _opened(here)):
                known = max(abs(found.value - value) for found in (before, here)) <= error
                if known and off(here) < min(KNOWN, HALF * off(before)):
                    return True
                far, near = off(before), off(here)
                if not near < far:
                    return False
                found = _further(motion, before, here, (1 - TENTH) * near / (far - near))
                if found is None or off(found) > HALF * near:
                    return False
                before, here = here, found
        except (ArithmeticError, ValueError):
            return False
        return before is not None and here is not None


def _further(motion: Motion, before: Exact, here: Exact, share: Any) -> Exact | None:
    """The orbit beyond the second one by so much of the way from the first one to it."""
    guess = [[x + share * (x - y) for x, y in zip(*rows)] for rows in zip(here.nodes, before.nodes)]
    return solved(motion, guess, here.value + share * (here.value - before.value))


def _opened(found: Exact) -> float:
    """By how much an orbit in doubles may miss its own beginning after a period."""
    size = max(abs(float(x)) for row in found.nodes for x in row)
    return min(KNOWN, float(np.spacing(size)) * _growth(found))


def _largest(found: Exact) -> float:
    """The multiplier of largest modulus; of a pair the modulus."""
    largest = found.multipliers[int(np.abs(found.multipliers).argmax())]
    return float(abs(largest) if largest.imag else largest.real)


def _growth(found: Exact) -> float:
    return float(np.abs(found.multipliers).max())
