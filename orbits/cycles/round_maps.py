"""The derivative of a round from those of its flights, and products of rounds, for `orbits.cycles.rounds`."""

from __future__ import annotations

import numpy as np


@np.errstate(all="ignore")
def through_flights(A: np.ndarray, D: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray] | None:
    """The product of -D_i^-1 A_i over all flights, and that of their absolute values; None where one cannot be solved for.

    Parameters
    ----------
    A, D : ndarray, shape (l, n, n)
        Derivatives of the equations of each flight by the node before it and after it; without D those of A are the factors.
    """
    try:
        factors = A if D is None else -np.linalg.solve(D, A)
    except np.linalg.LinAlgError:
        return None
    product = sizes = np.eye(A.shape[1])
    for factor in factors:
        product, sizes = factor @ product, np.abs(factor) @ sizes
    return product, sizes


@np.errstate(all="ignore")
def sides_of_cycles(maps: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each cycle of some rounds the least and the largest distance of its points from the border, and the product of its rounds.

    Parameters
    ----------
    maps : ndarray, shape (2, n, n)
        Derivatives of an unchanged and of a changed round.
    keys : ndarray of int, shape (c, 2)
        Numbers of rounds, and of changed ones, which come first.

    Returns
    -------
    sides : ndarray, shape (c, 2)
        det P_i (see `orbits.cycles.rounds`), counted positive on the side on which its first round is real; NaN where one is no number.
    products : ndarray, shape (c, n, n)
        Read from the first point.
    """
    rounds, changed = keys[:, :1], keys[:, 1:]
    firsts = np.arange(rounds.max(initial=1))[None, :]  # each cycle is read from each of its points at once
    P = np.broadcast_to(np.eye(maps.shape[1]), (len(keys), firsts.size, *maps.shape[1:]))
    M = maps[(changed[:, 0] > 0).astype(int)]
    for later in range(1, firsts.size):
        here = maps[((firsts + later) % rounds < changed).astype(int)]
        goes_on = (later < rounds)[:, :, None, None]
        P = np.where(goes_on, np.eye(maps.shape[1]) + here @ P, P)
        M = np.where(goes_on[:, 0], here[:, 0] @ M, M)
    found = np.where(firsts < changed, 1.0, -1.0) * np.linalg.det(P)
    exists = firsts < rounds
    low = np.where(exists, found, np.inf).min(axis=1)
    high = np.where(exists, found, -np.inf).max(axis=1)
    finite = (np.isfinite(found) | ~exists).all(axis=1)
    return np.where(finite[:, None], np.stack([low, high], axis=1), np.nan), M
