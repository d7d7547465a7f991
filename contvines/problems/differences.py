"""Differences with an error estimate, and what they tell of a function: lengths over which it bends, its noise."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import NamedTuple

import numpy as np

from contvines.shared.numbers import EPSILON

from .settings import DERIVATIVES

STEP = 0.006  # part of a length: roundoff eps/STEP and truncation STEP^6/140 meet near 1e-14
# sixth-order central difference: weights of f(x + k h) - f(x - k h), Fornberg, Math. Comp. 51 (1988) 699, table 1
SIXTH = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0)
FOURTH = (2.0 / 3.0, -1.0 / 12.0)
FACTOR = 64.0  # between the lengths that are tried by `bend`
ASIDE = 1.37  # ratio of two lengths at which slopes are compared
HALVINGS = 5  # of the factor between two of them, to find where f has bent
MANY = 64  # rows of fewer are asked one by one
CLOSER = 20  # halvings after which a continuous function has hardly changed any more
REACH = 9  # of them on either side of the guess: sixteen orders of magnitude

CLOSER_TABLES = 5  # of differences, each a thousand times closer than the one before
# stretches over which samples are compared with polynomials, as parts of a length; samples on each; degree
STRETCHES, SAMPLES, DEGREE = (0.1, 0.02, 0.004, 0.0008), 20, 8

Line = Callable[[float], np.ndarray]


class Difference(NamedTuple):
    """A derivative, the estimated error of each of its entries, and whether that is roundoff: a smaller step does not help."""

    value: np.ndarray
    error: np.ndarray
    settled: bool


def central(f: Line, h: float, noise: float | np.ndarray = 0.0) -> Difference:
    """Sixth-order central difference at 0.

    The error is estimated from the difference to the fourth-order one, of which a hundredth is kept (for a function that bends
    over a length L the ratio of the two errors is about (h/L)^2), and from the roundoff of f.

    Parameters
    ----------
    f : callable
        t -> ndarray.
    h : float
    noise : float or ndarray
        Standard deviation of f beyond roundoff.
    """
    ahead, back = [f(k * h) for k in (1, 2, 3)], [f(-k * h) for k in (1, 2, 3)]
    odd = [a - b for a, b in zip(ahead, back)]
    with np.errstate(all="ignore"):
        sixth = (SIXTH[0] * odd[0] + SIXTH[1] * odd[1] + SIXTH[2] * odd[2]) / h
        fourth = (FOURTH[0] * odd[0] + FOURTH[1] * odd[1]) / h
        size = np.maximum(np.abs(ahead[0]), np.abs(back[0]))
        truncation, roundoff = 0.01 * np.abs(sixth - fourth), (noise + EPSILON * size) / h
    settled = bool(truncation.max(initial=0.0) <= roundoff.max(initial=0.0))
    return Difference(sixth, truncation + roundoff, settled)


def along(f: Line, length: float, noise: float | np.ndarray = 0.0) -> Difference:
    """Derivative at 0 of a function of one real variable, with steps that shrink until the estimated error is small.

    Parameters
    ----------
    f : callable
        t -> ndarray.
    length : float
        Over which f may bend; the first step is a small part of it, the larger the more noise there is.
    noise : float or ndarray
        Standard deviation of f beyond roundoff.

    Returns
    -------
    Difference
        The best of those tried; not finite where f cannot be evaluated.
    """
    found = best = central(f, STEP * length, noise)
    least = _worst(best)
    if _relative(best) <= DERIVATIVES.roundoff or (best.settled and not np.any(np.asarray(noise) > 0.0)):
        return best
    rough = bool(np.any(np.asarray(noise) > 0.0))
    h, worse = (16.0 if rough else 0.125) * STEP * length, 0
    for _ in range(16):
        found = central(f, h, noise)
        error = _worst(found)
        if error < least or not np.isfinite(least):
            best, least, worse = found, error, 0
        elif np.isfinite(error):
            worse += 1
        if _relative(best) <= DERIVATIVES.roundoff or worse == 3 or found.settled:
            break
        h *= 0.125
    return best


def _worst(found: Difference) -> float:
    """Largest error; infinity where it is not finite."""
    error = float(found.error.max(initial=0.0))
    return error if np.isfinite(error) and np.isfinite(found.value).all() else np.inf


def _relative(found: Difference) -> float:
    """Largest error relative to the largest entry; infinity where it is not finite."""
    size, error = float(np.abs(found.value).max(initial=0.0)), float(found.error.max(initial=0.0))
    if not np.isfinite(size + error):
        return np.inf
    return error / size if size > 0.0 else float(error > 0.0)


def bend(f: Line, guess: float, enough: int = REACH, noise: float | np.ndarray = 0.0) -> float | None:
    """Length over which f stops being linear; None if it is linear, or no power law ends.

    The change of f grows like t as long as t is small; the length is where it is by half as much again, or less. What seems to
    bend where f has steps is rounding: then larger t are asked.

    Parameters
    ----------
    f : callable
        t -> ndarray; may be not finite far away.
    guess : float
        Lengths around this one are tried.
    enough : int
        How many on either side.
    noise : float or ndarray
        Standard deviation of f beyond roundoff.
    """
    with np.errstate(all="ignore"):
        here = f(0.0)
        felt = 30.0 * np.broadcast_to(noise, here.shape)
        floor = DERIVATIVES.cancelled * EPSILON * np.abs(here) + felt
        lengths = guess * FACTOR ** np.arange(-enough, enough + 1.0)
        odd = np.array([0.5 * (f(t) - f(-t)) for t in lengths])
        beside = np.array([0.5 * (f(ASIDE * t) - f(-ASIDE * t)) for t in lengths]) / (
            ASIDE * lengths[:, None]
        )
        even = np.array([0.5 * (f(t) + f(-t)) - here for t in lengths])
        seen = np.abs(odd) > floor + DERIVATIVES.cancelled * EPSILON * np.fmin.reduce(np.abs(odd), axis=0)
        slope = odd / lengths[:, None]
        # where rounding makes stairs of f, or it is a power, it is not linear
        seen &= np.abs(slope - beside) <= 0.05 * np.abs(slope)
        found, many = np.inf, odd.shape[1] > MANY
        for r in range(odd.shape[1]):
            # of many rows those that bend within the same factor are as good as one another: each asked costs evaluations of all
            least = found / FACTOR if many else found
            there = float(here[r])
            found = min(
                found,
                _bend_of_row(
                    f, r, there, lengths, slope[:, r], even[:, r], seen[:, r], least, float(felt[r])
                ),
            )
        if not np.isfinite(found) and not seen.any():
            found = _end_of_square(f, lengths, even, floor)
    return float(found) if np.isfinite(found) else None


def _end_of_square(f: Line, lengths: np.ndarray, even: np.ndarray, floor: np.ndarray) -> float:
    """Length up to which a function that is even grows like a square; infinity where it does all the way."""
    curvature = even / lengths[:, None] ** 2
    beside = np.array([0.5 * (f(ASIDE * t) + f(-ASIDE * t)) for t in lengths]) - f(0.0)
    beside /= (ASIDE * lengths[:, None]) ** 2
    seen = (np.abs(even) > floor) & (np.abs(curvature - beside) <= 0.05 * np.abs(curvature))
    found = np.inf
    for r in range(even.shape[1]):
        k = int(np.argmax(seen[:, r]))
        if seen[k, r]:
            ends = np.abs(curvature[:, r] - curvature[k, r]) > 0.5 * abs(curvature[k, r])
            ends = (ends | ~np.isfinite(curvature[:, r])) & (np.arange(len(lengths)) > k)
            if ends.any():
                found = min(found, float(lengths[int(np.argmax(ends))]) / np.sqrt(FACTOR))
    return found


def _bend_of_row(
    f: Line,
    r: int,
    here: float,
    lengths: np.ndarray,
    slope: np.ndarray,
    even: np.ndarray,
    seen: np.ndarray,
    least: float,
    felt: float,
) -> float:
    """Length over which row r bends, infinity where it does not, or not below `least`."""
    k = 0
    finite = np.isfinite(slope) & np.isfinite(even)
    for first in np.flatnonzero(seen):
        if first < k:
            continue
        reference = float(slope[first])
        bent = np.abs(slope - reference) + np.abs(even) / lengths > 0.5 * abs(reference)
        bent = (bent | ~finite) & (np.arange(len(lengths)) > first)
        if not bent.any():
            break
        k = int(np.argmax(bent))
        low, high = float(lengths[k - 1]), float(lengths[k])
        if low >= least:
            break
        for _ in range(HALVINGS):
            middle = np.sqrt(low * high)
            ahead, back = float(f(middle)[r]), float(f(-middle)[r])
            change = (
                abs(0.5 * (ahead - back) / middle - reference) + abs(0.5 * (ahead + back) - here) / middle
            )
            low, high = (middle, high) if change <= 0.5 * abs(reference) else (low, middle)
        if _continuous(f, high, r, felt):
            return high
    return np.inf


def noise_of(f: Line, spacing: float) -> np.ndarray:
    """Noise of each entry of f: its standard deviation, from tables of differences.

    More and Wild, Estimating computational noise, SIAM J. Sci. Comput. 33 (2011) 1292: the k-th difference of noise of
    variance s^2 has variance s^2 (2 k)!/(k!)^2, while that of a smooth function vanishes. What becomes less when the samples are a
    thousand times closer is no noise.

    Parameters
    ----------
    f : callable
        t -> ndarray.
    spacing : float
        Between the samples at first.
    """
    before, _ = _table(f, spacing)
    found, falling = before, np.ones(before.shape, dtype=bool)
    for _ in range(CLOSER_TABLES):
        spacing *= 0.001
        here, still = _table(f, spacing)
        falling &= ~still  # between two stairs, or two numbers of the machine, there is nothing to be seen
        less = here < 0.03 * before
        found = np.where(falling, np.where(less, here, np.maximum(before, here)), found)
        falling &= less
        if not falling.any():
            break
        before = here
    return found


def roughness(f: Line) -> np.ndarray:
    """Noise of each entry of f that is a staircase, or has jumps, so that it vanishes where samples are close together.

    What polynomials of degree DEGREE leave of samples over stretches that shrink: of a smooth function that falls with a high power of the
    stretch, of steps it stays the same as long as there are several of them.
    """
    places = np.modf(0.5 + 0.618033988749895 * np.arange(SAMPLES))[0] * 2.0 - 1.0
    basis, _ = np.linalg.qr(np.polynomial.chebyshev.chebvander(places, DEGREE))
    noise: np.ndarray | None = None
    before: np.ndarray | None = None
    for stretch in STRETCHES:
        table = np.array([f(stretch * t) for t in places])
        rest = table - basis @ (basis.T @ table)
        left = np.sqrt((rest**2).sum(axis=0) / (SAMPLES - DEGREE - 1))
        if before is None or noise is None:
            noise = np.zeros(left.shape)
        else:
            noise = np.where((left > 0.2 * before) & (noise == 0.0), left, noise)
        before = left
    assert noise is not None
    return noise


def _table(f: Line, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Noise of each entry from one table of differences, and whether most of its neighbours are one and the same number."""
    table = np.array([f(k * spacing) for k in range(9)])
    still = np.count_nonzero(np.diff(table, axis=0), axis=0) < 4
    estimates = []
    for k in range(1, 7):
        table = np.diff(table, axis=0)
        if k >= 4:
            gamma = factorial(k) ** 2 / factorial(2 * k)
            estimates.append(np.sqrt(gamma * (table**2).mean(axis=0)))
    return np.median(estimates, axis=0), still


def _continuous(f: Line, t: float, r: int, felt: float) -> bool:
    """Whether entry r of f, or of its mirror image, is continuous near t: no stairs that rounding makes of terms that cancel.

    Jumps up to `felt` are noise that is known.
    """
    for side in (t, -t):
        places = side * np.linspace(0.3, 1.2, 10)
        values = np.array([float(f(place)[r]) for place in places])
        if not np.isfinite(values).all():
            return True  # it cannot be evaluated there, which is a length, too
        k = int(np.argmax(np.abs(np.diff(values))))
        (low, high), (before, after) = places[k : k + 2], values[k : k + 2]
        whole = abs(after - before)
        for _ in range(CLOSER):
            middle = 0.5 * (low + high)
            value = float(f(middle)[r])
            if abs(value - before) > abs(after - value):
                high, after = middle, value
            else:
                low, before = middle, value
        if abs(after - before) > 0.05 * whole + felt:
            return False
    return True


def coupling(f: Callable[[float, float], np.ndarray], guess: float) -> float | None:
    """Size of an unknown that decides how f changes with another one, though f is linear in either; None if it does not.

    The change of f with the other unknown grows linearly with this one; the size is where it has doubled, or gone to zero.

    Parameters
    ----------
    f : callable
        (t, s) -> ndarray; this unknown is changed by t, the other one by the length over which f bends in it if s = 1.
    guess : float
        Sizes around this one are tried.
    """
    with np.errstate(all="ignore"):
        here, there = f(0.0, 0.0), f(0.0, 1.0)
        direct = np.abs(there - here)
        plain = direct > DERIVATIVES.cancelled * EPSILON * np.maximum(np.abs(here), np.abs(there))

        def both(t: float) -> tuple[np.ndarray, np.ndarray]:
            low, high = f(t, 0.0), f(t, 1.0)
            floor = DERIVATIVES.mixed * EPSILON * np.max([np.abs(low), np.abs(high), direct], axis=0)
            return np.abs((high - low) - (there - here)), floor

        for t in guess * FACTOR ** np.arange(-REACH, REACH + 1.0):
            mixed, floor = both(t)
            seen = plain & (mixed > floor) & np.isfinite(mixed)
            if seen.any():
                # where terms of this unknown cancel in a row, their rounding takes what the other one does, and no more
                seen &= np.abs(both(ASIDE * t)[0] / ASIDE - mixed) <= 0.05 * mixed
            if seen.any():
                return float(t * (direct[seen] / mixed[seen]).min())
    return None
