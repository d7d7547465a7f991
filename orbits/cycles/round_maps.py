"""The derivative of a round from those of its flights, and products of rounds, for `orbits.cycles.rounds`."""

from __future__ import annotations

import numpy as np

from contvines.core.library import NOTHING, POINTER, WHOLE, address, function, native

LARGEST = 8  # unknowns of a node for which the native core has room


def through_flights(A: np.ndarray, D: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray] | None:
    """The product of -D_i^-1 A_i over all flights, and that of their absolute values; None where one cannot be solved for.

    Parameters
    ----------
    A, D : ndarray, shape (l, n, n)
        Derivatives of the equations of each flight by the node before it and after it; without D those of A are the factors.
    """
    flights, n = A.shape[:2]
    if not native() or n > LARGEST:
        return reference_through_flights(A, D)
    A, D = np.ascontiguousarray(A, dtype=float), None if D is None else np.ascontiguousarray(D, dtype=float)
    product, sizes = np.empty((n, n)), np.empty((n, n))
    work = function("rounds_through_flights", WHOLE, WHOLE, WHOLE, POINTER, POINTER, POINTER, POINTER)
    after = None if D is None else address(D)
    return (product, sizes) if work(flights, n, address(A), after, address(product), address(sizes)) else None


def sides_of_cycles(maps: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each cycle of some rounds the least and the largest distance of its points from the border, and the product of its rounds.

    Parameters
    ----------
    maps : ndarray, shape (2, n, n)
        Derivatives of an unchanged and of a changed round.
    keys : ndarray of int64, shape (c, 2)
        Numbers of rounds, and of changed ones, which come first.

    Returns
    -------
    sides : ndarray, shape (c, 2)
        det P_i (see `orbits.cycles.rounds`), counted positive on the side on which its first round is real; NaN where one is no number.
    products : ndarray, shape (c, n, n)
        Read from the first point.
    """
    count, n = len(keys), maps.shape[1]
    if not native() or n > LARGEST:
        return reference_sides_of_cycles(maps, keys)
    maps, keys = np.ascontiguousarray(maps, dtype=float), np.ascontiguousarray(keys, dtype=np.int64)
    sides, products = np.empty((count, 2)), np.empty((count, n, n))
    work = function("rounds_sides_of_cycles", NOTHING, WHOLE, POINTER, WHOLE, POINTER, POINTER, POINTER)
    work(n, address(maps), count, address(keys), address(sides), address(products))
    return sides, products


@np.errstate(all="ignore")
def reference_through_flights(
    A: np.ndarray, D: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray] | None:
    """`through_flights` in numpy, which the native core is compared with."""
    whole = sizes = np.eye(A.shape[1])
    for i, factor in enumerate(A):
        if D is not None:
            try:
                factor = -np.linalg.solve(D[i], factor)
            except np.linalg.LinAlgError:
                return None
        whole, sizes = factor @ whole, np.abs(factor) @ sizes
    return whole, sizes


@np.errstate(all="ignore")
def reference_sides_of_cycles(maps: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`sides_of_cycles` in numpy, which the native core is compared with."""
    unit = np.eye(maps.shape[1])
    sides, products = np.empty((len(keys), 2)), np.empty((len(keys), *unit.shape))
    for c, (rounds, changed) in enumerate(keys):
        found = []
        for first in range(rounds):
            P, M = unit, maps[int(first < changed)]
            for later in range(1, rounds):
                here = maps[int((first + later) % rounds < changed)]
                P, M = unit + here @ P, here @ M
            if first == 0:
                products[c] = M
            found.append((1.0 if first < changed else -1.0) * np.linalg.det(P))
        sides[c] = (min(found), max(found)) if np.isfinite(found).all() else np.nan
    return sides, products
