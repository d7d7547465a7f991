"""Branch switching: from a special point to the first points of the branches that leave it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise, product

import numpy as np

from ..continuation.engine import Engine, Solved
from ..problems.protocol import Problem
from ..shared.numbers import EPSILON, ROUNDED
from .settings import LEAVING

KERNEL = 4  # largest number of null vectors that are used
MOST = 40  # largest number of branches that leave one point: half of 3^4 - 1, as where four mirrors meet
# least ratio of the distances of first points at amplitudes a and a / 2; for points of the known branch, which bends away, it is the root of two
LEAST_RATIO = 1.6
ATTEMPTS = 22  # largest number of halvings of the amplitude
LARGEST_MISS = 0.1  # largest distance of a first point from its hyperplane, in amplitudes
SHIFTS = (4.0 * EPSILON, -16.0 * EPSILON, 64.0 * EPSILON, -128.0 * EPSILON)  # relative shifts of unknowns


@dataclass(frozen=True)
class Departure:
    """A branch that leaves a branch point.

    Attributes
    ----------
    problem : Problem
        Problem of the branch that leaves (the larger problem at a period doubling or symmetry breaking).
    origin : Solved
        The branch point itself; its tangent points along the new branch.
    ahead, back : Solved or None
        First points on either side, at distances ``amplitude`` and ``-amplitude`` along the null vector; ``back`` is
        None where it is an image of ``ahead``.
    direction : ndarray, shape (N + 1,)
        Null vector, of unit length in the metric.
    amplitude : float
        Distance of the first points along the null vector, in the metric.
    curvature : float
        p = p0 + curvature * amplitude^2 (from the even part, extrapolated to zero amplitude).
    slope : float
        p = p0 + slope * amplitude (zero where ``back`` is an image of ``ahead``).
    family : bool
        The solutions form a continuous family, mapped to one another by a continuous symmetry; none of them is isolated.
    """

    problem: Problem
    origin: Solved
    ahead: Solved
    back: Solved | None
    direction: np.ndarray
    amplitude: float
    curvature: float
    slope: float
    family: bool = False

    def upright(self, unit: float, visible: float) -> bool:
        """Whether the parameter does not change along the branch: by no more than rounding of `unit`, over more than the `visible` length."""
        change = max(abs(self.ahead.p - self.origin.p), abs(self.slope) * self.amplitude)
        return change <= ROUNDED * unit and self.amplitude > visible


def null_vectors(
    engine: Engine,
    u: np.ndarray,
    p: float,
    tangent: np.ndarray,
    isolated: bool = False,
    most: int | None = None,
) -> list[np.ndarray]:
    """Compute null vectors of [[F_u, F_p], [tangent]]: images of random vectors under its inverse, made orthonormal in the metric.

    One application of the inverse is enough, as the matrix is singular to rounding. (Further inverse iterations need not
    converge to the null vector, as the matrix is far from normal.)

    The last row excludes the tangent of the branch itself. Usually there is one null vector; there are several (up to four, or to ``most``) if several
    multipliers cross at once, and none if (u, p) is not a branch point.

    Parameters
    ----------
    engine : Engine
    u : ndarray, shape (N,)
    p : float
    tangent : ndarray, shape (N + 1,)
    isolated : bool
        Test an ordinary point for isolated solutions, with the tolerance `Settings.isolated` instead of `Settings.null`.
    most : int, optional
        Largest number of null vectors.

    Returns
    -------
    list of ndarray, shape (N + 1,)
        Unit vectors in the metric.
    """
    border = engine.weights * tangent
    settings, found, first = engine.settings, list[np.ndarray](), 0.0
    singular = settings.isolated if isolated else settings.null
    for random in _random_vectors(min(KERNEL if most is None else most, KERNEL, engine.n), engine.n):
        side = engine.join(engine.row_sizes * random, 0.0)
        image = engine.apply_inverse(border, side) if found else _evaluated(engine, u, p, border, side)
        size = float(np.abs(image).max())
        if not np.isfinite(size):
            break
        image = image / size
        for other in found * 2:
            image = image - engine.inner(image, other) * other
        growth = size * engine.norm(image) * math.sqrt(engine.n / float(random @ random))
        first = max(first, growth)
        if growth < 1.0 / singular or growth < settings.null * first:
            break
        found.append(_oriented(engine, engine.unit(image)))
    return found


@lru_cache(maxsize=64)
def _random_vectors(count: int, n: int) -> np.ndarray:
    """Return fixed random vectors, shape (count, n)."""
    return np.random.default_rng(3).standard_normal((count, n))


def _evaluated(engine: Engine, u: np.ndarray, p: float, border: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Solve with the bordered matrix at a branch point, or beside it within rounding.

    The matrix may by chance be singular to the last bit; it is then evaluated at unknowns shifted by `SHIFTS`.
    """
    image = side
    for near in _shifted_by_rounding(engine, u):
        engine.residual(near, p)
        image = engine.apply_inverse(border, side)
        if np.isfinite(image).all():
            break
    return image


def _shifted_by_rounding(engine: Engine, u: np.ndarray) -> Iterator[np.ndarray]:
    """Generate the unknowns, then the same shifted by a few roundings."""
    yield u
    for part in SHIFTS:
        yield u + part * np.maximum(np.abs(u), engine.scale[:-1])


def _oriented(engine: Engine, vector: np.ndarray) -> np.ndarray:
    """Return the vector or its negative, so that the first of its large entries is negative.

    The inverse of a matrix that is singular to rounding gives a random sign, on which it depends which of two mirror images a
    diagram follows.
    """
    sizes = np.abs(vector[:-1]) / engine.scale[:-1]
    large = sizes > 0.3 * sizes.max()
    return -vector if large.any() and vector[int(np.argmax(large))] > 0.0 else vector


def departures(
    engine: Engine,
    u: np.ndarray,
    p: float,
    tangent: np.ndarray,
    amplitude: float,
    one_sided: bool,
    directions: list[np.ndarray] | None = None,
    most: int | None = None,
    exchanged: Callable[[Solved], bool] | None = None,
) -> list[Departure]:
    """Compute the branches that leave a branch point of the engine's problem.

    With one null vector: a point at distance ``amplitude`` along the null vector is corrected in the hyperplane through it, orthogonal to the null
    vector. The first Newton step solves the algebraic branching equation, so the component along the known branch need not be given.

    Parameters
    ----------
    engine : Engine
        Engine of the problem in which the point is a branch point.
    u, p, tangent
        The point, and the tangent of the known branch.
    amplitude : float
        First distance, in the metric; halved until the point can be corrected and lies close by.
    one_sided : bool
        The branch on the other side is an image of that on this side.
    directions : list of ndarray, optional
        Null vectors; computed if left out.
    most : int, optional
        Largest number of null vectors: the number of critical multipliers. Badly conditioned equations seem to have more.
    exchanged : callable, optional
        Whether the stability of a first point agrees with the exchange of stability at a single null vector. If not, it lies on another branch or
        behind another special point, and nearer points are tried.

    Returns
    -------
    list of Departure
    """
    if directions is None:
        directions = null_vectors(engine, u, p, tangent, most=most)
    point = _BranchPoint(engine, u, p, tangent, amplitude, one_sided)
    if len(directions) > 1:
        return point.multiple(directions)
    found = [point.leaving(direction, exchanged=exchanged) for direction in directions]
    return [departure for departure in found if departure is not None]


def _starts(k: int) -> np.ndarray:
    """Return unit vectors of k numbers, spread over half of the sphere: sums and differences of the axes, then random ones; shape (n, k)."""
    if k == 2:
        angles = np.arange(16) * np.pi / 16
        return np.column_stack([np.cos(angles), np.sin(angles)])
    plain = [np.array(signs, dtype=float) for signs in product((1.0, 0.0, -1.0), repeat=k) if any(signs)]
    plain = [v for v in plain if v[np.flatnonzero(v)[0]] > 0.0]
    more = np.random.default_rng(8).standard_normal((20 * k, k))
    vectors = np.vstack([plain, more])
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


Exchanged = Callable[[Solved], bool] | None


class _BranchPoint:
    """A branch point whose leaving branches are computed; see :func:`departures`."""

    def __init__(
        self, engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray, amplitude: float, one_sided: bool
    ) -> None:
        self.engine, self.u, self.p, self.tangent = engine, u, p, tangent
        self.amplitude, self.one_sided, self.z = amplitude, one_sided, engine.join(u, p)

    def multiple(self, directions: list[np.ndarray]) -> list[Departure]:
        """Compute the branches for several null vectors.

        Points all round the sphere that the null vectors span are corrected, first at the parameter of the branch point, then at parameter values
        shifted like those of the points found.
        """
        engine, amplitude, basis = self.engine, self.amplitude, np.array(directions)
        found: list[tuple[np.ndarray, float]] = []

        def search(offsets: list[float]) -> None:
            for share, offset in product(_starts(len(directions)), offsets):
                point = self.at(share @ basis, amplitude, offset, 10.0)
                if point is None:
                    continue
                gap = engine.join(point.u, point.p) - self.z
                direction = np.array([engine.inner(gap, v) for v in directions]) @ basis
                size = engine.norm(direction)
                direction = direction / size
                near = (1.0 - abs(engine.inner(direction, other)) for other, _ in found)
                if all(distance > engine.settings.near for distance in near):
                    found.append((direction, (point.p - self.p) / size**2))

        search([0.0])
        curvatures = [curvature for _, curvature in found]
        search(sorted({c * amplitude**2 * share for c in curvatures for share in (0.7, 1.4, -1.0)}))
        result = []
        for direction, curvature in found[:MOST]:
            departure = self.leaving(direction, curvature)
            if departure is None:
                continue
            ahead = departure.ahead
            if null_vectors(engine, ahead.u, ahead.p, ahead.tangent, isolated=True):
                # a point off the branch point is singular, too: it belongs to a continuous family of equivalent solutions
                return [replace(departure, family=True)]
            result.append(departure)
        return result

    def leaving(
        self, direction: np.ndarray, bend: float = 0.0, exchanged: Exchanged = None
    ) -> Departure | None:
        """Compute the branch in a direction, or None; `bend` is the parameter's curvature, as `Departure.curvature`."""
        trials = ((LEAST_RATIO, LEAVING.slanted), (LEAST_RATIO, LEAVING.grazing), (0.0, LEAVING.slanted))
        for test in (exchanged, None) if exchanged is not None else (None,):
            for trial in trials:
                found = self._branch_along(direction, bend, test, *trial)
                straight = None if found is None else self._other_direction(found)
                if straight is not None:
                    found = self._branch_along(straight, 0.0, test, *trial) or found
                if found is not None:
                    return found
        return None

    def at(self, direction: np.ndarray, amplitude: float, offset: float, reach: float) -> Solved | None:
        """Solve for the point at an amplitude in a direction, with the parameter shifted by `offset`; None if it is farther than `reach` amplitudes."""
        engine, border = self.engine, self.engine.weights * direction
        guess = self.z + amplitude * direction
        guess[-1] += offset
        along = direction if amplitude > 0.0 else -direction
        found = engine.solve(guess[:-1], guess[-1], border, float(border @ guess), along)
        if found is None:
            return None
        solved = engine.join(found.u, found.p)
        # this close to the branch point Newton's method may stop at rounding, off the hyperplane
        missed = abs(float(border @ (solved - guess))) > LARGEST_MISS * abs(amplitude)
        far = engine.norm(solved - self.z) > reach * abs(amplitude)
        return None if far or missed else found

    def _lined_up(self, point: Solved | None, near: Solved | None, least: float) -> bool:
        """Whether the distances of two points, the second one at half the amplitude, show that they lie on the same branch."""
        if point is None or near is None:
            return False
        away, nearby = (self.engine.join(p.u, p.p) - self.z for p in (point, near))
        far, close = self.engine.norm(away), self.engine.norm(nearby)
        return least * close < far < 3.5 * close and self.engine.inner(away, nearby) > 0.0

    @cached_property
    def _origin(self) -> Solved | None:
        """The branch point with its row, if necessary of a point beside it; see `_evaluated`."""
        border = self.engine.weights * self.tangent
        solved = (
            self.engine.polish(near, self.p, border, float(border @ self.z))
            for near in _shifted_by_rounding(self.engine, self.u)
        )
        found = next((point for point in solved if point is not None), None)
        return None if found is None else found._replace(u=np.array(self.u, dtype=float), sign=0.0)

    def _other_direction(self, found: Departure) -> np.ndarray | None:
        """If one of the two sides lies on the known branch, which turns round here (at a pitchfork), return the direction of the other one; else None.

        On a smooth branch the deviation from proportionality falls to a quarter at half the distance; on a branch that turns round, and behaves like
        a square root, it falls by less.
        """
        if found.back is None:
            return None
        engine, settings, rough, straight = self.engine, self.engine.settings, False, None
        for side, first in ((1.0, found.ahead), (-1.0, found.back)):
            nearer = (
                self.at(found.direction, side * found.amplitude * part, 0.0, LEAVING.grazing)
                for part in (0.5, 0.25)
            )
            gaps = [engine.join(point.u, point.p) - self.z for point in (first, *nearer) if point is not None]
            left = [engine.norm(wide - 2.0 * narrow) for wide, narrow in pairwise(gaps)]
            if len(left) == 2 and left[1] <= max(
                settings.crooked * left[0], settings.critical * found.amplitude
            ):
                straight = engine.unit(side * gaps[0])
            else:
                rough = True
        return straight if rough else None

    def _branch_along(
        self, direction: np.ndarray, bend: float, exchanged: Exchanged, least: float, reach: float
    ) -> Departure | None:
        """Compute the branch in a direction, from first points within `reach` amplitudes.

        A pair of points at amplitudes a and a / 2 is accepted if the ratio of their distances exceeds `least`. The amplitude is halved until
        the curvatures from both agree.
        """
        engine, p, one_sided, amplitude = self.engine, self.p, self.one_sided, self.amplitude
        best: Departure | None = None

        def at(distance: float) -> Solved | None:
            return self.at(direction, distance, bend * distance**2, reach)

        near, behind = at(amplitude), None if one_sided else at(-amplitude)
        for attempt in range(ATTEMPTS):
            if attempt >= 7 and best is not None:
                break
            half = 0.5 * amplitude
            ahead, near = near, at(half)
            back, behind = behind, None if one_sided else at(-half)
            if not self._lined_up(ahead, near, least) or (
                ahead is not None and exchanged is not None and not exchanged(ahead)
            ):
                ahead = None
            if not self._lined_up(back, behind, least):
                back = None
            both = one_sided or (back is not None and behind is not None)
            if ahead is not None and near is not None and both:
                if one_sided:
                    wide, narrow, slope = (ahead.p - p) / amplitude**2, (near.p - p) / half**2, 0.0
                else:
                    assert back is not None and behind is not None
                    wide = (0.5 * (ahead.p + back.p) - p) / amplitude**2
                    narrow = (0.5 * (near.p + behind.p) - p) / half**2
                    slope = (4.0 * (near.p - behind.p) - 0.5 * (ahead.p - back.p)) / (3.0 * amplitude)
                curvature = (4.0 * narrow - wide) / 3.0
                if self._origin is None:
                    return None
                chord = (
                    direction if back is None else engine.join(ahead.u, ahead.p) - engine.join(back.u, back.p)
                )
                origin = self._origin._replace(tangent=engine.unit(chord))
                best = Departure(engine.problem, origin, ahead, back, direction, amplitude, curvature, slope)
                if abs(wide - narrow) <= 0.02 * abs(narrow) + engine.settings.located / amplitude**2:
                    return best
            amplitude = half
        return best
