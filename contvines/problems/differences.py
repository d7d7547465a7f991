"""Derivatives by differences with an error estimate; the length over which a function is nonlinear; its noise."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import NamedTuple

import numpy as np

from contvines.shared.numbers import EPSILON

from .settings import DERIVATIVES

STEP = 0.006  # step as part of the length: roundoff eps/STEP and truncation STEP^6/140 are equal near 1e-14
# sixth-order central difference: weights of f(x + k h) - f(x - k h), Fornberg, Math. Comp. 51 (1988) 699, table 1
SIXTH = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0)
FOURTH = (2.0 / 3.0, -1.0 / 12.0)
FACTOR = 64.0  # ratio of successive lengths that `bend` tries
SECOND_LENGTH = 1.37  # ratio of two lengths whose slopes are compared; effects of rounding make them differ
HALVINGS = 5  # bisections between two tried lengths, to find where f becomes nonlinear
MANY = 64  # rows above which a row is examined only if its length is clearly shorter than the best so far
CLOSER = 20  # bisections after which a continuous function has hardly any change left
REACH = 9  # lengths that `bend` tries on either side of the guess: sixteen orders of magnitude

CLOSER_TABLES = 5  # tables of differences after the first, each with samples a thousand times closer
# lengths of the stretches on which samples are fitted by polynomials; samples on each; degree of the polynomials
STRETCHES, SAMPLES, DEGREE = (0.1, 0.02, 0.004, 0.0008), 20, 8

Line = Callable[[float], np.ndarray]


class Difference(NamedTuple):
    """A derivative ``value``, the estimated ``error`` of each entry, and whether roundoff dominates it (``settled``: a smaller step does not help)."""

    value: np.ndarray
    error: np.ndarray
    settled: bool


def central(f: Line, h: float, noise: float | np.ndarray = 0.0) -> Difference:
    """Sixth-order central difference at 0.

    The estimated error is one hundredth of the distance from the fourth-order difference (for a function that is nonlinear over a
    length L the ratio of the two errors is about (h/L)^2), plus the roundoff and noise of f.

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
        Length over which f may be nonlinear; the first step is a small part of it, a larger part if f has noise.
    noise : float or ndarray
        Standard deviation of f beyond roundoff.

    Returns
    -------
    Difference
        The one with the smallest estimated error; not finite if f cannot be evaluated.
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
    """Largest error; infinity if the derivative is not finite."""
    error = float(found.error.max(initial=0.0))
    return error if np.isfinite(error) and np.isfinite(found.value).all() else np.inf


def _relative(found: Difference) -> float:
    """Largest error relative to the largest entry; infinity if they are not finite."""
    size, error = float(np.abs(found.value).max(initial=0.0)), float(found.error.max(initial=0.0))
    if not np.isfinite(size + error):
        return np.inf
    return error / size if size > 0.0 else float(error > 0.0)


def bend(f: Line, guess: float, enough: int = REACH, noise: float | np.ndarray = 0.0) -> float | None:
    """Find the length over which f is nonlinear; None if it is linear, or a power law, at all lengths.

    For small t the change of f is proportional to t; at the length it deviates from that by half. Where rounding makes f a staircase it
    only seems nonlinear, and larger t are tried.

    Parameters
    ----------
    f : callable
        t -> ndarray; may be not finite far away.
    guess : float
        Lengths around this one are tried.
    enough : int
        Number of lengths on either side of the guess.
    noise : float or ndarray
        Standard deviation of f beyond roundoff.
    """
    with np.errstate(all="ignore"):
        centre = f(0.0)
        noticeable = 30.0 * np.broadcast_to(noise, centre.shape)
        floor = DERIVATIVES.cancelled * EPSILON * np.abs(centre) + noticeable
        lengths = guess * FACTOR ** np.arange(-enough, enough + 1.0)
        odd = np.array([0.5 * (f(t) - f(-t)) for t in lengths])
        nearby = np.array([0.5 * (f(SECOND_LENGTH * t) - f(-SECOND_LENGTH * t)) for t in lengths]) / (
            SECOND_LENGTH * lengths[:, None]
        )
        even = np.array([0.5 * (f(t) + f(-t)) - centre for t in lengths])
        reliable = np.abs(odd) > floor + DERIVATIVES.cancelled * EPSILON * np.fmin.reduce(np.abs(odd), axis=0)
        slope = odd / lengths[:, None]
        # slopes at t and at SECOND_LENGTH t differ where f is a staircase of rounding, or another power of t
        reliable &= np.abs(slope - nearby) <= 0.05 * np.abs(slope)
        found, many = np.inf, odd.shape[1] > MANY
        for r in range(odd.shape[1]):
            # of many rows, one within the same factor of the best is not examined: each costs evaluations of all rows
            least = found / FACTOR if many else found
            value = float(centre[r])
            found = min(
                found,
                _bend_of_row(
                    f, r, value, lengths, slope[:, r], even[:, r], reliable[:, r], least, float(noticeable[r])
                ),
            )
        if not np.isfinite(found) and not reliable.any():
            found = _end_of_square(f, lengths, even, floor)
    return float(found) if np.isfinite(found) else None


def _end_of_square(f: Line, lengths: np.ndarray, even: np.ndarray, floor: np.ndarray) -> float:
    """Length up to which an even function grows like t^2; infinity if it does so at all lengths."""
    curvature = even / lengths[:, None] ** 2
    nearby = np.array([0.5 * (f(SECOND_LENGTH * t) + f(-SECOND_LENGTH * t)) for t in lengths]) - f(0.0)
    nearby /= (SECOND_LENGTH * lengths[:, None]) ** 2
    reliable = (np.abs(even) > floor) & (np.abs(curvature - nearby) <= 0.05 * np.abs(curvature))
    found = np.inf
    for r in range(even.shape[1]):
        k = int(np.argmax(reliable[:, r]))
        if reliable[k, r]:
            ends = np.abs(curvature[:, r] - curvature[k, r]) > 0.5 * abs(curvature[k, r])
            ends = (ends | ~np.isfinite(curvature[:, r])) & (np.arange(len(lengths)) > k)
            if ends.any():
                found = min(found, float(lengths[int(np.argmax(ends))]) / np.sqrt(FACTOR))
    return found


def _bend_of_row(
    f: Line,
    r: int,
    centre: float,
    lengths: np.ndarray,
    slope: np.ndarray,
    even: np.ndarray,
    reliable: np.ndarray,
    least: float,
    noticeable: float,
) -> float:
    """Length over which row r is nonlinear; infinity if it is linear, or if the length is above `least`."""
    k = 0
    finite = np.isfinite(slope) & np.isfinite(even)
    for first in np.flatnonzero(reliable):
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
                abs(0.5 * (ahead - back) / middle - reference) + abs(0.5 * (ahead + back) - centre) / middle
            )
            low, high = (middle, high) if change <= 0.5 * abs(reference) else (low, middle)
        if _continuous(f, high, r, noticeable):
            return high
    return np.inf


def noise_of(f: Line, spacing: float) -> np.ndarray:
    """Noise of each entry of f: its standard deviation, from tables of differences.

    More and Wild, Estimating computational noise, SIAM J. Sci. Comput. 33 (2011) 1292: the k-th difference of noise of
    variance s^2 has variance s^2 (2 k)!/(k!)^2, while that of a smooth function vanishes. An estimate that falls when the samples are a
    thousand times closer is not noise.

    Parameters
    ----------
    f : callable
        t -> ndarray.
    spacing : float
        Distance between the samples of the first table.
    """
    before, _ = _table(f, spacing)
    found, falling = before, np.ones(before.shape, dtype=bool)
    for _ in range(CLOSER_TABLES):
        spacing *= 0.001
        noise, flat = _table(f, spacing)
        falling &= ~flat  # samples on one stair, or between two floating-point numbers, show no noise
        less = noise < 0.03 * before
        found = np.where(falling, np.where(less, noise, np.maximum(before, noise)), found)
        falling &= less
        if not falling.any():
            break
        before = noise
    return found


def roughness(f: Line) -> np.ndarray:
    """Noise of each entry of f that is a staircase or has jumps, which close samples do not show.

    Polynomials of degree DEGREE are fitted to samples on shrinking stretches. The residual of a smooth function falls with a high power
    of the stretch; that of a staircase stays the same as long as the stretch contains several steps.
    """
    places = np.modf(0.5 + 0.618033988749895 * np.arange(SAMPLES))[0] * 2.0 - 1.0
    basis, _ = np.linalg.qr(np.polynomial.chebyshev.chebvander(places, DEGREE))
    noise: np.ndarray | None = None
    before: np.ndarray | None = None
    for stretch in STRETCHES:
        table = np.array([f(stretch * t) for t in places])
        residual = table - basis @ (basis.T @ table)
        left = np.sqrt((residual**2).sum(axis=0) / (SAMPLES - DEGREE - 1))
        if before is None or noise is None:
            noise = np.zeros(left.shape)
        else:
            noise = np.where((left > 0.2 * before) & (noise == 0.0), left, noise)
        before = left
    assert noise is not None
    return noise


def _table(f: Line, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Noise of each entry from one table of differences, and whether most neighbouring samples are identical."""
    table = np.array([f(k * spacing) for k in range(9)])
    flat = np.count_nonzero(np.diff(table, axis=0), axis=0) < 4
    estimates = []
    for k in range(1, 7):
        table = np.diff(table, axis=0)
        if k >= 4:
            gamma = factorial(k) ** 2 / factorial(2 * k)
            estimates.append(np.sqrt(gamma * (table**2).mean(axis=0)))
    return np.median(estimates, axis=0), flat


def _continuous(f: Line, t: float, r: int, noticeable: float) -> bool:
    """Whether entry r of f is continuous near t and near -t, and no staircase of rounding of terms that cancel.

    Jumps up to `noticeable` are known noise and ignored.
    """
    for side in (t, -t):
        places = side * np.linspace(0.3, 1.2, 10)
        values = np.array([float(f(place)[r]) for place in places])
        if not np.isfinite(values).all():
            return True  # the end of the domain of f is a length, too
        k = int(np.argmax(np.abs(np.diff(values))))
        (low, high), (before, after) = places[k : k + 2], values[k : k + 2]
        jump = abs(after - before)
        for _ in range(CLOSER):
            middle = 0.5 * (low + high)
            value = float(f(middle)[r])
            if abs(value - before) > abs(after - value):
                high, after = middle, value
            else:
                low, before = middle, value
        if abs(after - before) > 0.05 * jump + noticeable:
            return False
    return True


def coupling(f: Callable[[float, float], np.ndarray], guess: float) -> float | None:
    """Size of an unknown from a bilinear term with another unknown; None if there is no such term.

    The derivative of f by the other unknown changes linearly with this one; the size is the change at which that derivative has doubled
    or vanished.

    Parameters
    ----------
    f : callable
        (t, s) -> ndarray; this unknown is changed by t, the other one by s times its length.
    guess : float
        Sizes around this one are tried.
    """
    with np.errstate(all="ignore"):
        start, end = f(0.0, 0.0), f(0.0, 1.0)
        direct = np.abs(end - start)
        plain = direct > DERIVATIVES.cancelled * EPSILON * np.maximum(np.abs(start), np.abs(end))

        def change(t: float) -> tuple[np.ndarray, np.ndarray]:
            low, high = f(t, 0.0), f(t, 1.0)
            floor = DERIVATIVES.mixed * EPSILON * np.max([np.abs(low), np.abs(high), direct], axis=0)
            return np.abs((high - low) - (end - start)), floor

        for t in guess * FACTOR ** np.arange(-REACH, REACH + 1.0):
            mixed, floor = change(t)
            reliable = plain & (mixed > floor) & np.isfinite(mixed)
            if reliable.any():
                # where large terms of this unknown cancel in a row, rounding absorbs the effect of the other one
                reliable &= np.abs(change(SECOND_LENGTH * t)[0] / SECOND_LENGTH - mixed) <= 0.05 * mixed
            if reliable.any():
                return float(t * (direct[reliable] / mixed[reliable]).min())
    return None
