"""Follow branches in many digits towards a special point, nearer than double precision allows."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from tools.fuzz.many_digits import DIGITS, Exact, Motion, solved

LARGE = 1e14  # size above which a multiplier counts as unbounded
FASTER = 100.0  # intended growth of multipliers in one step towards a border
GROWS = 10.0  # smallest accepted growth
NEAR = 1e-8  # largest difference of nodes between the last orbit and that of the border
PLACE = 1e-13  # largest relative difference of the parameter, in addition to the stated error of the border
THERE = 1e-9  # distance of nodes below which a special point is reached
KNOWN = 1e-5  # the same at most, if rounding or the stated error of the point allows a larger distance
TENTH, HALF = 0.1, 0.5  # intended and largest accepted ratio of distances after and before a step


def grow_without_bound(one: Any, nearer: Any, error: float) -> bool:
    """Whether the multipliers of a branch grow without bound (to `LARGE`) towards a border.

    The inverse of the growing multiplier tends to zero like the distance from the border or its square root, and changes its sign there. So the
    branch is followed in many digits towards the point at which the line through the inverses of the last two orbits vanishes.

    Parameters
    ----------
    one, nearer : Orbit
        Two orbits of the branch; the second one is at the border, to rounding and `error`.
    error : float
        Stated error of the border's parameter value.
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
        # the motion changes by `steepness * error` within the stated error of the border
        near = max(NEAR, min(KNOWN, here.steepness * error))
        return bool(moved < near and abs(here.value - value) < PLACE * max(1.0, abs(float(value))) + error)


def _nearer(motion: Motion, before: Exact, here: Exact) -> Exact | None:
    """Return the next orbit on the line through two orbits, with multipliers about `FASTER` times as large; None if they grow less than `GROWS` times.

    If the line overshoots the border, multipliers may be smaller, with the opposite sign.
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
    """Whether the branch through two orbits leads to the nodes of a third one; each step is predicted along the line through the last two orbits and solved.

    Near a branch point the equations are nearly singular, so an orbit solved in double precision may miss the point or belong to the other
    branch. The first two orbits must not be repetitions of shorter ones.
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
    """Return the orbit beyond the second one, at `share` times the distance between both."""
    guess = [[x + share * (x - y) for x, y in zip(*rows)] for rows in zip(here.nodes, before.nodes)]
    return solved(motion, guess, here.value + share * (here.value - before.value))


def _opened(found: Exact) -> float:
    """Distance by which an orbit in double precision may fail to close."""
    size = max(abs(float(x)) for row in found.nodes for x in row)
    return min(KNOWN, float(np.spacing(size)) * _growth(found))


def _largest(found: Exact) -> float:
    """Multiplier of largest modulus; for a pair its modulus."""
    largest = found.multipliers[int(np.abs(found.multipliers).argmax())]
    return float(abs(largest) if largest.imag else largest.real)


def _growth(found: Exact) -> float:
    return float(np.abs(found.multipliers).max())
