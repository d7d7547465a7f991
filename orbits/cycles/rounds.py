"""Cycles of several rounds next to a border, in some of which the change happens: which may be stable, and real?

At the border every round is the border cycle itself, seen with the old word or with the new one. Next to it the map of a round is, to
first order, x -> A x + b with the old word and x -> B x + b with the new one, where A and B, the derivatives of these cycles' own
maps, agree on the border. Cycles of this piecewise linear map are known in closed form: the multipliers are the
eigenvalues of the product M of its matrices, and the distances from the border of its points are proportional to det P_i, where P_i = 1 +
M_{n-1} + M_{n-1} M_{n-2} + ... + M_{n-1} ... M_1 when the cycle is read from its i-th point (Simpson & Meiss, SIAM J. Appl. Dyn. Syst. 8
(2009) 795, lemma 2: s_i = det(P_i) rho.b / det(1 - M)). So a cycle is real, on one side of the border, only where these have one
sign in all unchanged rounds and the other one in all changed ones.

At an impact of vanishing speed the derivatives grow without bound; there only the multipliers tell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

MOST = 8  # up to so many rounds of a cycle are joined to one at a border
UNSTABLE = 1.5  # a largest multiplier from which on a cycle is unstable, though the product is known next to the border only
ROUNDING = 1e-14  # of the derivative of a round, relative to the product of its factors' absolute values
SURE = 1e-3  # relative error of a derivative that is of use
DECIDED = 1e-2  # of the largest determinant: smaller ones have no sign to rely on
BOUNDED = 0.05  # relative change of the derivatives from one size of what grows to the next, where they have a limit


class Rounds(NamedTuple):
    """Derivatives of the two kinds of rounds.

    Attributes
    ----------
    maps : ndarray, shape (2, m, m)
        Of an unchanged and of a changed round.
    error : float
        Of both, relative to their largest entries.
    linear : bool
        Whether they have limits at the border, which agree on it.
    """

    maps: np.ndarray
    error: float
    linear: bool

    def hopeless(self, most: int) -> set[tuple[int, int]]:
        """Numbers of rounds (2 to `most`) and of changed ones (1, or all but one) of cycles that are surely not real, or, of more than
        two rounds, not stable.
        """
        keys, place, first, later = _sequences(most)
        n = self.maps.shape[1]
        one, both = np.eye(n), np.empty((len(first), n, 2 * n))  # P and M side by side
        both[:, :, :n], both[:, :, n:] = one, self.maps[first]
        with np.errstate(all="ignore"):
            for start, changed in later:
                part = both[start:]
                part[:] = self.maps[changed] @ part
                part[:, :, :n] += one
            torn = np.zeros(len(keys), bool)
            if self.linear:
                side = (2 * first - 1) * np.linalg.det(both[:, :, :n])
                low, high = np.minimum.reduceat(side, place), np.maximum.reduceat(side, place)
                torn = (low < -DECIDED * high) & (high > -DECIDED * low)
            sizes = np.abs(self.maps).sum(axis=2).max(axis=1)
            rounds, changed = np.array(keys).T
            error = rounds * self.error * sizes[0] ** (rounds - changed) * sizes[1] ** changed
            M = both[place, :, n:]
            known = np.isfinite(M).all(axis=(1, 2)) & np.isfinite(error)
            radius = np.abs(np.linalg.eigvals(np.where(known[:, None, None], M, 0.0))).max(axis=1)
            unstable = known & (rounds > 2) & (radius > UNSTABLE + error)
        return {key for key, no in zip(keys, (torn | unstable).tolist()) if no}


@cache
def choices(most: int) -> list[tuple[int, int]]:
    """Numbers of rounds, and of changed ones among them, of the cycles that are looked at."""
    return [(n, changed) for n in range(2, most + 1) for changed in dict.fromkeys((1, n - 1))]


@cache
def _sequences(
    most: int,
) -> tuple[list[tuple[int, int]], np.ndarray, np.ndarray, list[tuple[int, np.ndarray]]]:
    """(rounds, changed) of the cycles; then, cycle by cycle and read from each of their points: where a cycle begins, whether its
    first round is changed, and for each later round the first of those that have it, and whether it is changed in these.
    """
    keys = choices(most)
    rows, count, place = [], [], []
    for n, changed in keys:
        word = [1] * changed + [0] * (n - changed)
        place.append(len(rows))
        rows += [word[i:] + word[:i] + [0] * (most - n) for i in range(n)]
        count += [n] * n
    chosen = np.array(rows)
    starts = [int(np.searchsorted(count, k, side="right")) for k in range(most)]
    later = [(starts[k], chosen[starts[k] :, k].copy()) for k in range(1, most)]
    return keys, np.array(place), chosen[:, 0].copy(), later


def judged(kinds: Sequence[Sequence[tuple[np.ndarray, float] | None]]) -> Rounds | None:
    """Rounds from the derivatives, with their errors, of unchanged and of changed ones, from far to near the border; None where they
    cannot be told.
    """
    found, error, bounded = [], 0.0, True
    for maps in kinds:
        if not maps or any(m is None for m in maps):
            return None
        far, near = maps[0], maps[-1]
        assert far is not None and near is not None
        found.append(near[0])
        size = float(np.abs(near[0]).max())
        error = max(error, near[1] / size if size > 0.0 else 0.0)
        bounded = bounded and bool(np.abs(far[0] - near[0]).max() <= BOUNDED * max(size, 1.0))
    if not error <= SURE:
        return None
    return Rounds(np.array(found), error, bounded and _agree(*found))


def _agree(plain: np.ndarray, changed: np.ndarray) -> bool:
    """Whether two derivatives differ by a matrix of rank one: on the border the maps are the same."""
    values = np.linalg.svd(changed - plain, compute_uv=False)
    return len(values) < 2 or bool(values[1] <= BOUNDED * max(float(values[0]), np.abs(plain).max()))


def derived(factors: np.ndarray) -> tuple[np.ndarray, float] | None:
    """The derivative of a round from those of its flights (l, n, n), and its rounding; None where it is no number."""
    whole, sizes = product(np.array([factors, np.abs(factors)]))
    error = ROUNDING * float(sizes.max())
    return (whole, error) if np.isfinite(whole).all() and math.isfinite(error) else None


def product(factors: np.ndarray) -> np.ndarray:
    """M_{l-1} ... M_0 of factors (..., l, n, n), neighbours first."""
    while (count := factors.shape[-3]) > 1:
        pairs = factors[..., 1::2, :, :] @ factors[..., : count - count % 2 : 2, :, :]
        factors = np.concatenate([pairs, factors[..., -1:, :, :]], axis=-3) if count % 2 else pairs
    return factors[..., 0, :, :]


def escape(symmetric: bool, rounds: int) -> str:
    """What becomes of the period where only some of so many rounds change."""
    if rounds == 2:
        return f"the {'symmetry breaks' if symmetric else 'period doubles'} at the border"
    if symmetric and rounds % 2 == 0:
        return f"at the border the symmetry breaks and the period becomes {rounds // 2} times as long"
    return f"at the border the period becomes {rounds} times as long"
