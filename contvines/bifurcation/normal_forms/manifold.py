"""Reduction to the critical directions: Taylor coefficients of a centre manifold and of the normal form on it, to any order.

There are m coordinates w on the critical directions, complex ones in conjugate pairs; H(w) = V w + ... is the manifold, N(w) = L w + ...
the normal form. With the equations R(u, v) of one period, where v is the start of the next period, or F(u) of a flow, the homological equations

    maps    R(H(w), H(N(w))) = 0,        flows    F(H(w)) = DH(w) N(w),

are solved degree by degree. The residual of the lower degrees is sampled along lines through the origin, a polynomial fit gives its Taylor
coefficients, and new terms of H, and of N for the monomials that the normal form has, balance them. A term that could be in both is put into
N, and H then has no part along the critical vector (w.K h = 0). Source of the method: Kuznetsov, SIAM
J. Numer. Anal. 36 (1999) 1104, with the multilinear forms replaced by sampling.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import qr

from ...shared.numbers import TINY
from ..locate import chebyshev_nodes
from ..settings import NORMAL_FORMS
from .taylor import taylor_weights

if TYPE_CHECKING:
    from .coefficients import Forms

NODES = 26  # samples along a line
SPREAD = 1.3  # number of lines per monomial
CANDIDATES = 8  # number of random lines from which each line is chosen
WIDEST = 0.6  # first radius of the samples, relative to the size of the unknowns
NARROWER = 0.7  # ratio of successive radii

Monomial = tuple[int, ...]
Series = dict[Monomial, np.ndarray]


def monomials(m: int, degree: int) -> list[Monomial]:
    """Return the exponents of all monomials of a degree in m coordinates."""
    return [
        tuple(sum(place == i for place in chosen) for i in range(m))
        for chosen in combinations_with_replacement(range(m), degree)
    ]


def powers(w: np.ndarray, exponents: Sequence[Monomial]) -> np.ndarray:
    """Return the values of monomials, shape (n, number), at points w of shape (n, m)."""
    return np.stack([np.prod(w ** np.array(a), axis=1) for a in exponents], axis=1)


def values_of(series: Mapping[Monomial, np.ndarray], w: np.ndarray) -> np.ndarray:
    """Return the values of a polynomial, shape (n, ...), at points w of shape (n, m)."""
    return powers(w, list(series)) @ np.array(list(series.values()))


def substitution(linear: np.ndarray, degree: int, flow: bool) -> np.ndarray:
    """Return the matrix T with (L w)^a = sum_b T[a, b] w^b; for flows, with the derivative of w^a along L w on the left side."""
    m = len(linear)
    wanted = monomials(m, degree)
    place = {a: i for i, a in enumerate(wanted)}
    table = np.zeros((len(wanted), len(wanted)), dtype=complex)
    for i, a in enumerate(wanted):
        factors = [j for j in range(m) for _ in range(a[j])]
        for skipped in range(degree) if flow else (None,):
            ranges = [
                range(m) if skipped is None or k == skipped else (factor,) for k, factor in enumerate(factors)
            ]
            for chosen in product(*ranges):
                weight = complex(1.0)
                for k, (old, new) in enumerate(zip(factors, chosen)):
                    weight *= linear[old, new] if skipped is None or k == skipped else 1.0
                if weight != 0.0:
                    table[i, place[tuple(sum(c == j for c in chosen) for j in range(m))]] += weight
    return table


class Reduction:
    """Centre manifold and normal form of a problem at one point, computed degree by degree.

    Parameters
    ----------
    forms : Forms
        Equations at the point: J, K and ``rests`` are used.
    vectors : ndarray of complex, shape (N, m)
        Critical directions; those of complex coordinates in conjugate pairs.
    linear : ndarray of complex, shape (m, m)
        L; diagonal, or with Jordan blocks.
    real : ndarray of complex, shape (m, m)
        w = real @ xi for real xi: (1, i; 1, -i) for a conjugate pair.
    stay : sequence of (int, Monomial)
        Terms of the normal form: index of the equation, exponents of the monomial.
    radius : float
        Radius of the samples, in units of the unknowns.

    Attributes
    ----------
    H : dict of Monomial -> ndarray, shape (N,)
        Coefficients of the manifold.
    N : dict of Monomial -> ndarray, shape (m,)
        Coefficients of the normal form.
    """

    def __init__(
        self,
        forms: Forms,
        vectors: np.ndarray,
        linear: np.ndarray,
        real: np.ndarray,
        stay: Sequence[tuple[int, Monomial]],
        radius: float,
    ) -> None:
        self.forms, self.linear, self.real, self.radius = forms, np.asarray(linear, complex), real, radius
        self.m = len(self.linear)
        self.vectors, self.stay = np.asarray(vectors, complex), list(stay)
        units = [tuple(int(i == j) for i in range(self.m)) for j in range(self.m)]
        self.H: Series = {unit: self.vectors[:, j] for j, unit in enumerate(units)}
        self.N: dict[Monomial, np.ndarray] = {unit: self.linear[:, j].copy() for j, unit in enumerate(units)}
        self.degree = 1

    def to(self, degree: int) -> Reduction:
        """Compute all terms up to a degree.

        Raises
        ------
        ValueError
            If the equations cannot be evaluated at a sample.
        """
        while self.degree < degree:
            self.degree += 1
            self._balance(self.degree)
        return self

    # ------------------------------------------------------------------ residual of the homological equations
    def _residual(self, w: np.ndarray) -> np.ndarray:
        """Return the residual of the homological equations with the current H and N at points w, shape (n, N)."""
        points, drift = np.real(values_of(self.H, w)), values_of(self.N, w)
        if not self.forms.flow:
            return self.forms.rests(points, np.real(values_of(self.H, drift)))
        rate = np.zeros(points.shape, dtype=complex)
        for j in range(self.m):
            slopes = {_lowered(a, j): a[j] * c for a, c in self.H.items() if a[j]}
            rate += drift[:, j, None] * values_of(slopes, w)
        return self.forms.rests(points, None) - np.real(rate)

    def _residual_terms(self, degree: int) -> np.ndarray:
        """Return the Taylor coefficients of this degree of the residual, shape (number of monomials, N)."""
        wanted = monomials(self.m, degree)
        lines = directions(self.m, degree)
        points = lines @ self.real.T
        sizes = np.abs(points).max(axis=1) * max(float(np.abs(self.vectors).max()), TINY)
        radii = self.radius / sizes
        with np.errstate(over="ignore", invalid="ignore"):  # tested below
            samples = self._residual(
                ((radii[:, None] * chebyshev_nodes(NODES))[:, :, None] * points[:, None, :]).reshape(
                    -1, self.m
                )
            )
        if not np.isfinite(samples).all():
            raise ValueError("the equations cannot be evaluated near the special point")
        samples = samples.reshape(len(lines), NODES, -1)
        values = np.einsum("k,lkn->ln", taylor_weights(NODES, degree), samples) / radii[:, None] ** degree
        return np.linalg.lstsq(powers(points, wanted), values.astype(complex), rcond=None)[0]

    # ------------------------------------------------------------------ new terms
    def _balance(self, degree: int) -> None:
        """Compute the terms of H and N of one degree; monomials are solved for one by one if L is diagonal, else together."""
        wanted, left = monomials(self.m, degree), self._residual_terms(degree)
        table = substitution(self.linear, degree, self.forms.flow)
        diagonal = np.abs(table - np.diag(np.diag(table))).max() == 0.0
        groups = [[b] for b in range(len(wanted))] if diagonal else [list(range(len(wanted)))]
        for group in groups:
            self._solve(group, wanted, left, table)

    def _solve(self, group: list[int], wanted: list[Monomial], left: np.ndarray, table: np.ndarray) -> None:
        """Solve the linear equations for the terms of a group of monomials (indices into `wanted`)."""
        forms, n = self.forms, self.forms.n
        open_ = forms.J if forms.flow else forms.J - forms.K
        allowed = [(i, b) for b in group for i, a in self.stay if a == wanted[b]]
        size = n * len(group)
        matrix = np.zeros((size, size + len(allowed)), dtype=complex)
        for row, b in enumerate(group):
            rows = slice(row * n, (row + 1) * n)
            matrix[rows, rows] += open_
            for column, a in enumerate(group):
                matrix[rows, column * n : (column + 1) * n] += table[a, b] * forms.K
            for k, (i, place) in enumerate(allowed):
                if place == b:
                    matrix[rows, size + k] = forms.K @ self.vectors[:, i]
        side = -left[group].reshape(-1)
        if len(group) == 1 and allowed:  # additional equations w.K h = 0: no part along the critical vectors
            lefts = [forms.null(table[group[0], group[0]])[1] for _ in allowed]
            rows = np.array([np.append(w @ forms.K, np.zeros(len(allowed))) for w in lefts])
            matrix, side = np.vstack([matrix, rows]), np.append(side, np.zeros(len(allowed)))
        found = np.linalg.lstsq(matrix, side, rcond=NORMAL_FORMS.cutoff)[0]
        for row, b in enumerate(group):
            self.H[wanted[b]] = found[row * n : (row + 1) * n]
        for k, (i, b) in enumerate(allowed):
            self.N.setdefault(wanted[b], np.zeros(self.m, dtype=complex))[i] = found[size + k]


@cache
def directions(m: int, degree: int) -> np.ndarray:
    """Return lines through the origin in m real coordinates that distinguish the monomials of a degree well: unit vectors, shape (n, m)."""
    wanted = monomials(m, degree)
    count = int(np.ceil(SPREAD * len(wanted))) + 1
    if m == 1:
        return np.ones((1, 1))
    if m == 2:
        angles = np.pi * (np.arange(count) + 0.25) / count
        return np.column_stack([np.cos(angles), np.sin(angles)])
    lines = np.random.default_rng(3).standard_normal((CANDIDATES * count, m))
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    chosen: list[int] = []
    left = np.arange(len(lines))
    while len(chosen) < count:  # lines with the most independent monomials, then again among the others
        pivots = np.asarray(qr(powers(lines[left], wanted).T, mode="r", pivoting=True)[-1])[: len(wanted)]
        chosen += left[pivots].tolist()
        left = np.delete(left, pivots)
    return lines[chosen[:count]]


def _lowered(exponents: Monomial, j: int) -> Monomial:
    """Return the exponents with the j-th one lowered by one."""
    return tuple(e - (i == j) for i, e in enumerate(exponents))


def reduced(
    forms: Forms,
    vectors: np.ndarray,
    linear: np.ndarray,
    real: np.ndarray,
    stay: Sequence[tuple[int, Monomial]],
    degree: int,
    wanted: Callable[[dict[Monomial, np.ndarray]], Mapping[str, float]],
) -> dict[str, float]:
    """Compute the coefficients of a normal form, from the radius of samples at which they are most accurate.

    Parameters
    ----------
    forms, vectors, linear, real, stay
        As for :class:`Reduction`.
    degree : int
        Degree of the normal form.
    wanted : callable
        N -> coefficients by name.

    Raises
    ------
    ValueError
        If the equations cannot be evaluated near the point, or the coefficients are not known to two digits.
    """
    # the vectors have unit length in the user's units; the reduction uses vectors of unit length in the units of `forms`
    lengths = np.linalg.norm(vectors, axis=0)
    if np.count_nonzero(linear - np.diag(np.diag(linear))):
        lengths[:] = lengths[0]  # a Jordan chain
    best: dict[Monomial, np.ndarray] = {}
    error, before = np.inf, None
    steps = int(np.ceil(np.log(NORMAL_FORMS.narrowest / (WIDEST * forms.reach)) / np.log(NARROWER)))
    for radius in WIDEST * forms.reach * NARROWER ** np.arange(steps + 1):
        try:
            normal_form = Reduction(forms, vectors / lengths, linear, real, stay, radius).to(degree).N
        except ValueError:
            continue
        current = dict(wanted(normal_form))
        if before is not None:
            sizes = max(TINY, *map(abs, current.values()))
            change = max(abs(current[name] - before[name]) for name in current) / sizes
            if change < error:
                error, best = change, normal_form
                if error < NORMAL_FORMS.enough:
                    break
            elif error < NORMAL_FORMS.digits and change > 100.0 * error:  # rounding dominates
                break
        before = current
    if not error < NORMAL_FORMS.digits:
        raise ValueError("the coefficients are not known to two digits")
    return dict(wanted({a: part * np.prod(lengths ** np.array(a)) / lengths for a, part in best.items()}))
