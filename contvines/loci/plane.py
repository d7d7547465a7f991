"""Plane: a problem at points of the plane of two parameters, and Newton's method for any conditions there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .linear import Linearisation
from .probing import pair_of
from .problem import LocusProblem

STEP = 1e-5  # of central differences of the conditions, relative to the unknowns
ITERATIONS, HALVINGS = 16, 4  # of Newton's method
FAST = 0.1  # part of the last correction below which slopes of a costly condition need not be renewed
ROUNDOFF = 1e-12  # relative size of a derivative that is none
SETTLED = 64.0 * np.finfo(float).eps  # corrections that are rounding
CLOSE = 1e-9  # corrections below this no longer shrink: roundoff of the conditions


class Place(NamedTuple):
    """A point (u, p, q)."""

    u: np.ndarray
    p: float
    q: float


def settled(size: float, last: float, close: float = CLOSE) -> bool:
    """Whether a correction is the last: rounding of the unknowns, or one that is below `close` and shrinks no more."""
    return size < SETTLED or (size < close and size > 0.3 * last)


class Plane:
    """Evaluates F and its derivatives, multipliers and margins at (u, p, q).

    Parameters
    ----------
    locus : LocusProblem
        Whose problem and parameters are meant.
    """

    def __init__(self, locus: LocusProblem) -> None:
        self.locus, self.problem = locus, locus.base
        self.flow = self.problem.spectrum == "flow"
        self.m = int(self.problem.n_multipliers)
        # problems of its own: a trace changes the parameters of the locus in place
        self.first = Linearisation(self.problem.against(locus.inner))
        self.second = Linearisation(self.first.problem.against(locus.over))
        self.place, self.residual = Place(np.zeros(locus.size), 0.0, 0.0), np.inf
        self._row: np.ndarray | None = None

    def at(self, place: Place) -> float:
        """Linearise in the first parameter, unless the plane is there already; returns the largest residual."""
        if place is not self.place:
            self.first.kernels.assign(self.first.data, self.second.data, float(place.q))
            self.place, self._row = place, None
            self.residual = self.first.at(place.u, place.p)
        return self.residual

    @property
    def slope_across(self) -> np.ndarray:
        """F_q, at the place."""
        u, p, q = self.place
        self.second.kernels.assign(self.second.data, self.first.data, float(p))
        self.second.at(u, q)
        return self.second.slope

    @property
    def row(self) -> np.ndarray:
        """Multipliers as (re, im) pairs, then margins."""
        if self._row is None:
            self._row = self.first.row()
        return self._row

    @property
    def spectrum(self) -> NDArray[np.complex128]:
        """Raw multipliers, or eigenvalues."""
        return self.row[0 : 2 * self.m : 2] + 1j * self.row[1 : 2 * self.m : 2]

    def pair(self, reference: float) -> tuple[float, float]:
        """(test, position) of the pair of multipliers nearest to the boundary and to a reference; see ``pair_of``."""
        found = np.zeros(2)
        pair_of(self.row, self.m, self.flow, reference, found)
        return float(found[0]), float(found[1])

    def other_pair(self, reference: float, second: float) -> float:
        """The test of the complex pair nearest to a second reference, of those that are not the one nearest to the first; see ``pair_of``."""
        upper = self.spectrum[self.spectrum.imag > 0.0]
        if len(upper) < 2:
            return np.nan
        tests = 2.0 * upper.real if self.flow else np.abs(upper) ** 2 - 1.0
        places = np.abs(upper) ** 2 if self.flow else upper.real
        unit = 1.0 + abs(reference) if self.flow else 1.0
        own = int(np.argmin(np.abs(tests) + 0.1 * np.abs(places - reference) / unit))
        rest = [i for i in range(len(upper)) if i != own]
        return float(tests[min(rest, key=lambda i: abs(places[i] - second))])

    def two_nearest(self, place: float) -> float:
        """Sum of the two multipliers nearest to a place of the real axis, less twice that place."""
        spectrum = self.spectrum
        nearest = spectrum[np.argsort(np.abs(spectrum - place), kind="stable")[:2]]
        return float(np.real(np.sum(nearest)) - 2.0 * place)

    def singular_test(self, b: np.ndarray, c: np.ndarray, flipped: bool = False) -> float:
        """g of F_u, or of the flipped one, with given borders."""
        with self.first.flipped() if flipped else nullcontext():
            return self.first.null(b, c)[1]

    def unfolding_test(self, b: np.ndarray, c: np.ndarray) -> float:
        """The second condition of a branch point: the part of F_p that F_u does not reach."""
        return self.first.solve(-self.first.slope, b, c)[1]

    def refined(
        self,
        conditions: Sequence[Callable[[Plane], float]],
        guess: Place,
        reach: float,
        unfolded: bool,
        close: float = CLOSE,
        rough: Callable[[Plane], float] | None = None,
    ) -> tuple[Place, float] | None:
        """Newton's method for F = 0 and the conditions; (place, last correction), or None.

        Parameters
        ----------
        conditions : two functions of the plane, or three where F is unfolded
        guess : Place
        reach : float
            Largest distance from the guess, relative to the scales of the unknowns, at which the solution is still meant.
        unfolded : bool
            F = 0 is asked for up to one multiple of the left null vector.
        close : float
            Corrections below this no longer shrink: roundoff of the conditions.
        rough : callable, optional
            The last condition is costly; this is what its slopes are taken from, and no more often than corrections ask for.
        """
        kept: np.ndarray | None = None  # slopes of the costly condition along p, q and the null vector
        u, p, q = np.array(guess.u), guess.p, guess.q
        scale = self.locus.sizes_at(u, p, q)
        last, change, halvings = np.inf, np.zeros(len(u) + 2), 0
        for _ in range(ITERATIONS):
            if not math.isfinite(self.at(Place(u, p, q))):
                return None
            line = self.first
            null = line.null_vectors()
            b, c = null.column, null.row
            sides = (-line.residual, -line.slope, -self.slope_across)
            solved = [line.solve(side, b, c) for side in sides]
            v, g = line.null(b, c)
            directions = [np.append(solved[0][0], [0.0, 0.0]), np.append(solved[1][0], [1.0, 0.0])]
            directions += [np.append(solved[2][0], [0.0, 1.0]), np.append(v, [0.0, 0.0])]
            here = Place(u, p, q)
            values = np.array([f(self) for f in conditions])
            asked = conditions
            if rough is not None:
                asked = conditions[:-1] if kept is not None else [*conditions[:-1], rough]
            slopes = np.array([self._slope(asked, here, d, scale) for d in directions])
            if kept is not None:
                slopes = np.column_stack([slopes, np.append(0.0, kept)])
            if not (np.isfinite(values).all() and np.isfinite(slopes).all()):
                # beyond the end of what a condition can be asked for (a pair that has become real): half the way
                halvings += 1
                if halvings > HALVINGS or not change.any():
                    return None
                change = 0.5 * change
                u, p, q = u - change[:-2], p - float(change[-2]), q - float(change[-1])
                continue
            rows, right = [slopes[1:].T], [-values - slopes[0]]
            if not unfolded:
                rows.append(np.array([[solved[1][1], solved[2][1], g]]))
                right.append(np.array([-solved[0][1]]))
            # in units of parameters and null vector, and of what F changes by
            matrix, side, units = np.vstack(rows), np.concatenate(right), np.append(scale[-2:], 1.0)
            try:
                if not unfolded and float(np.abs(matrix[2] * units).max()) < ROUNDOFF:
                    # where branches cross F is zero to first order, and asks for nothing there
                    dp, dq, a = units * np.linalg.lstsq(matrix[:2] * units, side[:2])[0]
                else:
                    dp, dq, a = np.linalg.solve(matrix, side)
            except np.linalg.LinAlgError:
                return None
            change = directions[0] + dp * directions[1] + dq * directions[2] + a * directions[3]
            size = float((np.abs(change) / scale).max())
            if not size < 10.0 * max(reach, 1e-3):
                return None
            change[-2:] = dp, dq
            u, p, q = u + change[:-2], p + float(dp), q + float(dq)
            if settled(size, last, close if kept is None else 0.0):
                last = size
                break
            kept = slopes[1:, -1] if rough is not None and size < FAST * last else None
            last = size
        if last > close:
            return None
        far = np.append(np.abs(u - guess.u), [abs(p - guess.p), abs(q - guess.q)]) / scale
        if far.max() > reach or not self.at(Place(u, p, q)) < 1e-6:
            return None
        return Place(u, p, q), last

    def _slope(
        self,
        conditions: Sequence[Callable[[Plane], float]],
        place: Place,
        direction: np.ndarray,
        scale: np.ndarray,
    ) -> np.ndarray:
        length = float((np.abs(direction) / scale).max())
        if length < 1e-13:
            return np.zeros(len(conditions))
        h = STEP / length
        ends = []
        for sign in (1.0, -1.0):
            shifted = sign * h * direction
            moved = Place(place.u + shifted[:-2], place.p + shifted[-2], place.q + shifted[-1])
            if not math.isfinite(self.at(moved)):
                return np.full(len(conditions), np.nan)
            ends.append(np.array([f(self) for f in conditions]))
        with np.errstate(invalid="ignore"):  # a margin without anything to watch is infinite on both sides
            return (ends[0] - ends[1]) / (2.0 * h)
