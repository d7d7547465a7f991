"""Plane: a problem at points of the plane of two parameters, and test functions there."""

from __future__ import annotations

from contextlib import nullcontext
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .linear import Linearisation
from .probing import pair_of
from .problem import LocusProblem


class Place(NamedTuple):
    """A point (u, p, q)."""

    u: np.ndarray
    p: float
    q: float


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
            assert self.first.kernels.assign is not None
            self.first.kernels.assign(self.first.data, self.second.data, float(place.q))
            self.place, self._row = place, None
            self.residual = self.first.at(place.u, place.p)
        return self.residual

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
