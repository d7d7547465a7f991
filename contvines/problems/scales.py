"""Scales: typical sizes of the unknowns, of the parameter and of the equations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.shared.numbers import ROUNDED

from .differences import FACTOR, HALVINGS, REACH, bend, coupling

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


FIELD_GAP = 30.0  # of many unknowns, those whose sorted sizes have no gap by this factor belong to one field
MANY = 20  # up to so many unknowns, each has its own scale


@dataclass(frozen=True)
class Scales:
    """Typical sizes of unknowns, parameter and equations.

    Attributes
    ----------
    unknowns : ndarray, shape (N,)
    parameter : float
    rows : ndarray, shape (N,)
        Change of each equation when every unknown and the parameter change by their scale.
    rate : float
        Typical size of an eigenvalue of dF/du.
    noise : float
        Error of the unknowns that noise of the equations causes, relative to their scale; 0: roundoff only.
    untold : tuple of int
        Indices of unknowns whose size could not be learned; their scale is 1.
    """

    unknowns: np.ndarray
    parameter: float
    rows: np.ndarray
    rate: float = 1.0
    noise: float = 0.0
    untold: tuple[int, ...] = ()

    @cached_property
    def vector(self) -> np.ndarray:
        """Scales of (u, p)."""
        return np.append(self.unknowns, self.parameter)

    def head(self, n: int) -> Scales:
        """Return the scales of the first n unknowns only."""
        return Scales(self.unknowns[:n], self.parameter, self.rows[:n], self.rate, self.noise)

    def tiled(self, times: int) -> Scales:
        """Return the scales of a problem whose unknowns are `times` copies of these."""
        return Scales(
            np.tile(self.unknowns, times), self.parameter, np.tile(self.rows, times), self.rate, self.noise
        )


def flat_start(u0: ArrayLike, name: str = "u0") -> np.ndarray:
    """Return a user's start as a new flat array.

    Parameters
    ----------
    u0 : array_like
    name : str
        Name of the argument, for messages.

    Raises
    ------
    ValueError
        If it is empty, contains no numbers, or has several axes.
    """
    try:
        start = np.array(u0, dtype=float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} = {u0!r} must be numbers, one for each unknown: {error}") from None
    if start.size == 0:
        raise ValueError(f"{name} is empty; give a start for each unknown")
    if start.ndim > 1:
        raise ValueError(
            f"{name} has shape {start.shape}; the equations see their unknowns in a row: give {name} of shape ({start.size},)"
        )
    return start.reshape(-1)


def given_scale(scale: ArrayLike | None, n: int) -> np.ndarray | None:
    """Return a user's ``scale`` as an array of n positive numbers; None stays None.

    Raises
    ------
    ValueError
        If it is anything else.
    """
    if scale is None:
        return None
    try:
        values = np.array(np.broadcast_to(np.asarray(scale, dtype=float), (n,)))
    except (TypeError, ValueError):
        raise ValueError(
            f"scale = {scale!r} must be a positive number, or {n} of them, one per unknown"
        ) from None
    if not (np.isfinite(values).all() and (values > 0.0).all()):
        raise ValueError(f"scale = {scale!r} must be positive and finite")
    return values


def in_fields(sizes: np.ndarray) -> np.ndarray:
    """Give the unknowns of one field the same size, if there are many; gaps in the sorted sizes separate the fields.

    The values of a discretised field are small next to a boundary, but their scale is the same as elsewhere.
    """
    if len(sizes) <= MANY:
        return sizes
    order = np.argsort(sizes)
    gaps = np.flatnonzero(sizes[order][1:] > FIELD_GAP * sizes[order][:-1])
    result = np.empty_like(sizes)
    for part in np.split(order, gaps + 1):
        result[part] = np.sqrt((sizes[part] ** 2).mean())
    return result


EACH = 64  # up to so many unknowns, the length of each is measured; of more, one length for all
PAIRS = 12  # up to so many unknowns, bilinear terms of pairs are measured
FEW = 2  # lengths tried on either side of the guess if the function is slow
PARAMETER_CHANGE = 2.0**-17  # relative change of the parameter from which the size of its terms is computed
HUGE = 20  # powers of 1 / `ROUNDED` that are tried: from the smallest floating-point number to the largest
PATIENCE = 0.5  # seconds that measuring all lengths may take

Values = Callable[[np.ndarray], np.ndarray]


class Extents(NamedTuple):
    """Lengths of the unknowns, and their origin.

    Attributes
    ----------
    lengths : ndarray, shape (n,)
        Change of each unknown over which f is nonlinear; where f is linear, the unknown's size, or 1 if that is zero.
    bends : ndarray of bool, shape (n,)
        Whether f is nonlinear in each unknown.
    known : ndarray of bool, shape (n,)
        Whether the length comes from f or from the unknown itself; else it is just 1.
    """

    lengths: np.ndarray
    bends: np.ndarray
    known: np.ndarray


def measured(
    f: Values, u: np.ndarray, grain: float | np.ndarray, cost: float, terms: float | np.ndarray = 0.0
) -> Extents:
    """Measure the lengths of the unknowns at u.

    Parameters
    ----------
    f : callable
        (u of shape (n,)) -> n numbers, not finite where f cannot be evaluated.
    u : ndarray, shape (n,)
    grain : float or ndarray
        Standard deviation of f.
    cost : float
        Seconds that a call takes.
    terms : float or ndarray
        See :func:`of_rounding`.
    """
    n, unit = len(u), np.eye(len(u)) if len(u) <= EACH else None
    tries = REACH if (1 if unit is None else n) * 77 * cost < PATIENCE else FEW
    if tries > FEW:
        u = np.where(of_rounding(f, u, terms), 0.0, u)
    lengths, bends, known = np.where(u == 0.0, 1.0, np.abs(u)), np.zeros(n, dtype=bool), u != 0.0
    with np.errstate(all="ignore"):
        if unit is None:
            largest = float(np.abs(u).max()) or 1.0
            direction = np.where(u == 0.0, largest, u)
            direction /= np.abs(direction).max()
            found = bend(lambda t: f(u + t * direction), largest, tries, grain)
            lengths[:] = largest if found is None else found
            bends[:] = found is not None
            return Extents(lengths, bends, known | bends)
        for j in range(n):
            found = bend(lambda t, j=j: f(u + t * unit[j]), float(lengths[j]), tries, grain)
            if found is not None:
                lengths[j], bends[j], known[j] = found, True, True
        if tries > FEW and n <= PAIRS:
            _couple(f, u, unit, lengths, known)
    return Extents(lengths, bends, known)


def of_parameter(f: Callable[[float], np.ndarray], p: float) -> np.ndarray:
    """Size of the terms with the parameter in each equation: |p dF/dp|; 0 where it cannot be computed.

    Parameters
    ----------
    f : callable
        (p) -> n numbers.
    p : float
    """
    with np.errstate(all="ignore"):
        found = np.abs(f(p + PARAMETER_CHANGE * p) - f(p)) / PARAMETER_CHANGE
    return np.where(np.isfinite(found), found, 0.0)


def of_rounding(f: Values, u: np.ndarray, terms: float | np.ndarray = 0.0) -> np.ndarray:
    """Which unknowns are zeros up to rounding, shape (n,): they are too small to have an effect on f, but larger values have one.

    Parameters
    ----------
    f : callable
    u : ndarray, shape (n,)
    terms : float or ndarray
        Size of the other terms of each equation, see :func:`of_parameter`.
    """
    found = np.zeros(len(u), dtype=bool)
    if len(u) > EACH:
        return found
    with np.errstate(all="ignore"):
        value = f(u)

        def change(j: int, factor: float) -> np.ndarray:
            shifted = u.copy()
            shifted[j] *= factor
            return np.abs(f(shifted) - value)

        # zero may be another solution, so that f does not change: twice the unknown is tried, too
        changes = np.array([np.maximum(change(j, 0.0), change(j, 2.0)) for j in range(len(u))])
        floor = ROUNDED * np.maximum(changes.max(axis=0), terms)
        for j in np.flatnonzero((u != 0.0) & (changes <= floor).all(axis=1)):
            found[j] = any((change(int(j), ROUNDED**-k) > floor).any() for k in range(1, HUGE))
    return found


def _couple(f: Values, u: np.ndarray, unit: np.ndarray, lengths: np.ndarray, known: np.ndarray) -> None:
    """Set the lengths of unknowns that are zero and in which f is linear, from bilinear terms with others; in place."""
    for j in np.flatnonzero(~known):
        sizes = []
        for k in range(len(u)):
            if k != j:

                def plane(t: float, s: float, j: int = int(j), k: int = k) -> np.ndarray:
                    return f(u + t * unit[j] + s * lengths[k] * unit[k])

                sizes.append(coupling(plane, 1.0))
        found = [size for size in sizes if size]
        if found:
            lengths[j], known[j] = min(found), True


def weighed(
    f: Values, matrix: np.ndarray, lengths: np.ndarray, known: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Set unknown lengths so that the terms of these unknowns in an equation are as large as those of unknowns with known lengths.

    Linear terms are used first. For the rest, groups of unknowns that linear terms connect get a common factor from their even terms.

    Parameters
    ----------
    f : callable
        (v of shape (n,)) -> values of the equations if the unknowns are changed by v; not finite where they cannot be evaluated.
    matrix : ndarray, shape (n, n)
        Derivatives of the equations.
    lengths : ndarray, shape (n,)
    known : ndarray of bool, shape (n,)

    Returns
    -------
    lengths : ndarray, shape (n,)
    known : ndarray of bool, shape (n,)
    """
    lengths, known, matrix = lengths.copy(), known.copy(), np.abs(matrix)
    _spread(matrix, lengths, known)
    tried = known.copy()
    while known.any() and not tried.all():
        part = tried.copy()
        part[int(np.argmin(tried))] = True
        _spread(np.where(tried, 0.0, matrix), lengths, part)
        part &= ~tried
        rows = (matrix * np.where(known, lengths, 0.0)).max(axis=1)
        factor = _even_factor(f, np.where(part, lengths, 0.0), rows)
        tried |= part
        if factor is not None:
            lengths[part] *= factor
            known |= part
            _spread(matrix, lengths, known)
            tried |= known
    return lengths, known


def _spread(matrix: np.ndarray, lengths: np.ndarray, known: np.ndarray) -> None:
    """Set lengths by linear terms, in place, step by step from the known ones; of several rows the largest length counts."""
    while not known.all():
        rows = (matrix * np.where(known, lengths, 0.0)).max(axis=1)
        with np.errstate(all="ignore"):
            sizes = np.where((rows[:, None] > 0.0) & (matrix > 0.0), rows[:, None] / matrix, 0.0).max(axis=0)
        found = ~known & (sizes > 0.0) & np.isfinite(sizes)
        if not found.any():
            return
        lengths[found] = sizes[found]
        known |= found


def _even_factor(f: Values, direction: np.ndarray, rows: np.ndarray) -> float | None:
    """Factor of a direction at which the even part of some row reaches `rows`; None if there is none."""
    direction = direction * np.random.default_rng(5).uniform(0.5, 1.0, len(direction))
    with np.errstate(all="ignore"):
        centre = f(np.zeros(len(direction)))

        def reached(t: float) -> bool:
            even = 0.5 * (f(t * direction) + f(-t * direction)) - centre
            return bool(np.any((np.abs(even) > rows) & (rows > 0.0)))

        factors = FACTOR ** np.arange(-REACH, REACH + 1.0)
        k = next((k for k, t in enumerate(factors) if reached(t)), 0)
        if k == 0:
            return None
        low, high = float(factors[k - 1]), float(factors[k])
        for _ in range(HALVINGS):
            middle = float(np.sqrt(low * high))
            low, high = (low, middle) if reached(middle) else (middle, high)
    return high
