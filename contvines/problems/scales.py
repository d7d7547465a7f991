"""Scales: what counts as large in each unknown, in the parameter and in each equation."""

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


APART = 30.0  # of many unknowns those whose sizes differ by less belong to one field
MANY = 20  # unknowns of fewer have each its own scale


@dataclass(frozen=True)
class Scales:
    """Typical sizes.

    Attributes
    ----------
    unknowns : ndarray, shape (N,)
    parameter : float
    rows : ndarray, shape (N,)
        Change of each equation when every unknown and the parameter change by their scale.
    rate : float
        Typical size of an eigenvalue of dF/du.
    noise : float
        Accuracy to which unknowns can be obtained, relative to their scale; 0: to roundoff.
    untold : tuple of int
        Unknowns of which nothing tells how large they become; their scale is 1.
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
        """Of the first n unknowns only."""
        return Scales(self.unknowns[:n], self.parameter, self.rows[:n], self.rate, self.noise)

    def tiled(self, times: int) -> Scales:
        """For a problem that consists of that many copies of the unknowns."""
        return Scales(
            np.tile(self.unknowns, times), self.parameter, np.tile(self.rows, times), self.rate, self.noise
        )


def flat_start(u0: ArrayLike, name: str = "u0") -> np.ndarray:
    """A user's start as a flat array of its own.

    Parameters
    ----------
    u0 : array_like
    name : str
        What it is called, for messages.

    Raises
    ------
    ValueError
        If it is empty, no numbers, or has several axes.
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
    """A user's ``scale`` as an array of n positive numbers; None stays None.

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
    """Sizes of many unknowns, those of one field made equal: a field is what no gap in the sorted sizes parts.

    The value of a field next to a wall is small, but what counts as large there is what counts as large elsewhere.
    """
    if len(sizes) <= MANY:
        return sizes
    order = np.argsort(sizes)
    gaps = np.flatnonzero(sizes[order][1:] > APART * sizes[order][:-1])
    result = np.empty_like(sizes)
    for part in np.split(order, gaps + 1):
        result[part] = np.sqrt((sizes[part] ** 2).mean())
    return result


EACH = 64  # up to so many unknowns each one's length is measured; of more, one for all
PAIRS = 12  # up to so many, couplings between two of them are looked at
FEW = 2  # lengths tried on either side where the function is slow
BESIDE = 2.0**-17  # part of the parameter by which it is changed to see its terms
HUGE = 20  # times 1 / `ROUNDED` in a row: from the smallest number to the largest
PATIENCE = 0.5  # seconds that measuring lengths may take

Values = Callable[[np.ndarray], np.ndarray]


class Extents(NamedTuple):
    """Sizes of the unknowns.

    Attributes
    ----------
    lengths : ndarray, shape (n,)
        Over which f bends in each unknown; where it does not, the unknown's size, or 1.
    bends : ndarray of bool, shape (n,)
        Where it does.
    known : ndarray of bool, shape (n,)
        Where the length comes from f or from the unknown itself, and is not just 1.
    """

    lengths: np.ndarray
    bends: np.ndarray
    known: np.ndarray


def measured(
    f: Values, u: np.ndarray, grain: float | np.ndarray, cost: float, terms: float | np.ndarray = 0.0
) -> Extents:
    """Sizes of the unknowns at u.

    Parameters
    ----------
    f : callable
        (u of shape (n,)) -> n numbers, not finite where they cannot be obtained.
    u : ndarray, shape (n,)
    grain : float or ndarray
        Standard deviation of f.
    cost : float
        Seconds of a call.
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
    """Size of the terms with the parameter in each equation, p times the derivative; 0 where it cannot be obtained.

    Parameters
    ----------
    f : callable
        (p) -> n numbers.
    p : float
    """
    with np.errstate(all="ignore"):
        found = np.abs(f(p + BESIDE * p) - f(p)) / BESIDE
    return np.where(np.isfinite(found), found, 0.0)


def of_rounding(f: Values, u: np.ndarray, terms: float | np.ndarray = 0.0) -> np.ndarray:
    """Which unknowns are zeros that rounding has moved, shape (n,): f does not feel them beside the others, but would if they were larger.

    Parameters
    ----------
    f : callable
    u : ndarray, shape (n,)
    terms : float or ndarray
        Size of what else is in each equation, see :func:`of_parameter`.
    """
    found = np.zeros(len(u), dtype=bool)
    if len(u) > EACH:
        return found
    with np.errstate(all="ignore"):
        here = f(u)

        def change(j: int, factor: float) -> np.ndarray:
            moved = u.copy()
            moved[j] *= factor
            return np.abs(f(moved) - here)

        # zero may be another solution: twice the unknown is asked for as well
        changes = np.array([np.maximum(change(j, 0.0), change(j, 2.0)) for j in range(len(u))])
        floor = ROUNDED * np.maximum(changes.max(axis=0), terms)
        for j in np.flatnonzero((u != 0.0) & (changes <= floor).all(axis=1)):
            found[j] = any((change(int(j), ROUNDED**-k) > floor).any() for k in range(1, HUGE))
    return found


def _couple(f: Values, u: np.ndarray, unit: np.ndarray, lengths: np.ndarray, known: np.ndarray) -> None:
    """Lengths of unknowns that are zero and in which f is linear, but which decide how it changes with others."""
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
    """Lengths of unknowns of which nothing else is known: where they weigh as much in an equation as those that are known.

    By their linear terms first, then, those together that are linked by such terms, by what is even in them.

    Parameters
    ----------
    f : callable
        (v of shape (n,)) -> values of the equations where the unknowns are changed by v; not finite where they cannot be obtained.
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
    asked = known.copy()
    while known.any() and not asked.all():
        part = asked.copy()
        part[int(np.argmin(asked))] = True
        _spread(np.where(asked, 0.0, matrix), lengths, part)
        part &= ~asked
        rows = (matrix * np.where(known, lengths, 0.0)).max(axis=1)
        factor = _even(f, np.where(part, lengths, 0.0), rows)
        asked |= part
        if factor is not None:
            lengths[part] *= factor
            known |= part
            _spread(matrix, lengths, known)
            asked |= known
    return lengths, known


def _spread(matrix: np.ndarray, lengths: np.ndarray, known: np.ndarray) -> None:
    """Lengths by linear terms, row by row outwards from what is known; of several rows the largest."""
    while not known.all():
        rows = (matrix * np.where(known, lengths, 0.0)).max(axis=1)
        with np.errstate(all="ignore"):
            says = np.where((rows[:, None] > 0.0) & (matrix > 0.0), rows[:, None] / matrix, 0.0).max(axis=0)
        found = ~known & (says > 0.0) & np.isfinite(says)
        if not found.any():
            return
        lengths[found] = says[found]
        known |= found


def _even(f: Values, direction: np.ndarray, rows: np.ndarray) -> float | None:
    """Factor of a direction at which what is even of some row along it reaches `rows`; None if there is none."""
    direction = direction * np.random.default_rng(5).uniform(0.5, 1.0, len(direction))
    with np.errstate(all="ignore"):
        here = f(np.zeros(len(direction)))

        def reached(t: float) -> bool:
            even = 0.5 * (f(t * direction) + f(-t * direction)) - here
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
