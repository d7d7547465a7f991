"""Segment: the part of a branch between two neighbouring points, on which any point can be solved; location of special points on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, cached_property
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval, chebvander

from ..continuation.engine import Engine, Solved
from ..continuation.layout import Aim, Found, Way, solved_point, solved_points
from ..continuation.trace import MeshMotion
from ..shared.numbers import EPSILON, ROUNDED
from .scan import counts
from .settings import LOCATING

NODES = 8  # Chebyshev nodes of an interpolation beside a branch point
NARROWER = 0.5 ** np.arange(7)  # widths of the windows that are tried, relative to the first one
WIDER = 2.0 ** np.arange(1, 6)  # further widths, for short segments on which rounding dominates
NOWHERE = (math.nan, math.nan)  # bracket that is not known yet
FAR = 3.0  # decades between |multiplier| and 1 from which a multiplier is certainly not near the circle


class Segment:
    """The part of a branch between points a and b; the position s in [0, 1] is measured along the chord.

    Parameters
    ----------
    engine : Engine
    a, b : Solved
        Ends. Their tangents make an angle of less than 90 degrees with the chord.
    turns : bool
        This is a part of a segment on which a fold has been found. A change of sign of the parameter's component of the tangent then counts as a fold
        however small the component is, so that all parts together have as many folds.

    Attributes
    ----------
    za, zb : ndarray, shape (N + 1,)
        The ends as (u, p); za is on the mesh of b, if the mesh was adapted between.
    length : float
        Length of the chord in the metric.
    direction, border : ndarray, shape (N + 1,)
        Unit vector along the chord, and the same times the weights of the metric.
    way : Way
        The chord as the loop takes it.
    """

    def __init__(self, engine: Engine, a: Solved, b: Solved, turns: bool = False) -> None:
        self.engine, self.a, self.b, self.turns = engine, a, b, turns
        chord_ends = np.empty((4, engine.n + 1))
        self.za, self.zb = chord_ends[0], chord_ends[2]
        self.za[:-1], self.za[-1], self.zb[:-1], self.zb[-1] = a.u, a.p, b.u, b.p
        begin, end = a.tangent, b.tangent
        read = MeshMotion(engine).carried(a.u, b.u, begin)
        if read is not None:
            self.za[:-1] = read
        chord = self.zb - self.za
        self.length = engine.norm(chord)
        self.direction = chord / self.length if self.length > 0.0 else a.tangent
        if read is not None:
            begin = end = self.direction  # tangents of different meshes cannot be compared
        turn = begin - end
        self.border = engine.weights * self.direction
        arc = self.length * (1.0 + engine.inner(turn, turn) / 24.0)
        np.multiply(arc, begin, out=chord_ends[1])
        np.multiply(arc, end, out=chord_ends[3])
        self.way = Way(chord_ends, float(self.border.dot(self.za)), self.length, self.border, self.direction)

    @cached_property
    def counts(self) -> tuple[list[int], list[int]]:
        """Numbers of multipliers outside the circle at both ends, each as [real ones past 1, real ones past -1, complex pairs]."""
        engine = self.engine
        before, after = counts(engine, np.array([self.a.row, self.b.row])).tolist()
        return (before, before) if engine.adaptive and self._far_from_circle() else (before, after)

    def _far_from_circle(self) -> bool:
        """Whether equally many multipliers are outside the circle at both ends, and all are so far from the circle that none has crossed it.

        Beside a homoclinic orbit multipliers go round zero, and change their sort without crossing the circle.
        """
        sizes = np.abs(self.engine.spectrum(np.array([self.a.row, self.b.row])))
        with np.errstate(all="ignore"):
            logs = np.abs(np.log10(sizes))
        outside = (sizes > 1.0).sum(axis=1)
        return bool((logs > FAR).all() and outside[0] == outside[1])

    def through_infinity(self) -> bool:
        """Whether the largest multipliers of both ends are real, of opposite signs, and so large that one has passed through infinity."""
        spectra = self.engine.spectrum(np.array([self.a.row, self.b.row]))
        one, other = spectra[(0, 1), np.abs(spectra).argmax(axis=1)]
        far = min(abs(one), abs(other)) > 10.0**FAR and one.imag == other.imag == 0.0
        return bool(far and one.real * other.real < 0.0)

    def at(self, s: float) -> Solved | None:
        """Return the point of the branch at s, solved to rounding; None if it cannot be solved or belongs to another branch."""
        return solved_point(self.found((s,)), 0)

    def several(self, places: Sequence[float] | np.ndarray) -> list[Solved | None]:
        """Return the points of the branch at some positions, each as by `at`."""
        return solved_points(self.found(places))

    def rows(self, places: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rows of multipliers and margins at k positions, shape (k, columns), and whether each point was solved, shape (k,)."""
        found = self.found(places)
        return found.rows, found.numbers[:, 1] >= 0.0

    def found(self, places: Sequence[float] | np.ndarray) -> Found:
        """Return the points at some positions as arrays."""
        return self.engine.on_chord(self.way, np.array(places, dtype=float))


class Root(NamedTuple):
    """A located zero of a test function.

    Attributes
    ----------
    position : float
        s in [0, 1] on the segment.
    point : Solved
    error : float
        Estimated error of the parameter value.
    continuous : bool
        False if the test function jumps over zero.
    """

    position: float
    point: Solved
    error: float
    continuous: bool = True


class Role(StrEnum):
    """Role of a located point in the continuation of its branch."""

    SPECIAL = "special"  # a special point of the branch
    BORDER = "border"  # a margin vanishes: the branch ends
    MEETING = "meeting"  # the branch returns to the fixed space of a symmetry, and ends
    STOP = "stop"  # zero of a user function at which branches shall end
    LEFT = "left"  # the branch leaves the parameter interval between two points inside it
    UNRESOLVED = "unresolved"  # the ends of a segment, which is not halved any more, disagree with the special points found on it
    PLAIN = "plain"  # an ordinary point between two special points
    LEAP = "leap"  # the point before a step that jumped to another branch: trace again with shorter steps
    LANDING = "landing"  # the point before a step that ended next to a meeting: repeat it with another length


@dataclass(frozen=True, eq=False)
class Located:
    """A point located on a chunk or a segment.

    Attributes
    ----------
    position : float
        On a segment: s in [0, 1]. On a chunk: index of the point before it plus s.
    point : Solved
    kind : str
        Name of the kind, see :mod:`contvines.bifurcation.kinds`; for a meeting the kind of the symmetry. Empty for the roles PLAIN, LEAP, LANDING and LEFT.
    index : int
        Index of the multiplier, margin, symmetry or user function.
    role : Role
    error : float
        Estimated error of the parameter value.
    bracket : (float, float)
        Parameter values at the ends of the segment.
    name : str
        Name of the user function.
    rounding : float
        For a border: by how much rounding of its margins may move the parameter value. Part of the final error, but no sign of a leap.
    astray : bool
        True if this is no special point: the segment has jumped from one branch to another.
    """

    position: float
    point: Solved
    kind: str = ""
    index: int = 0
    role: Role = Role.SPECIAL
    error: float = 0.0
    bracket: tuple[float, float] = NOWHERE
    name: str = ""
    rounding: float = 0.0
    astray: bool = False

    @classmethod
    def at(
        cls, root: Root, kind: str, index: int = 0, role: Role = Role.SPECIAL, astray: bool = False
    ) -> Located:
        """Return the located point for a zero of a test function."""
        return cls(root.position, root.point, "" if astray else kind, index, role, root.error, astray=astray)

    @property
    def ends_branch(self) -> bool:
        """Whether the branch ends at this point."""
        return self.role in (Role.BORDER, Role.MEETING, Role.STOP, Role.LEFT)


def locate(
    segment: Segment,
    test: Callable[[Solved], float] | Aim,
    tolerance: float = LOCATING.bracket,
    jump: float = np.inf,
) -> Root | None:
    """Locate the zero of a test function on a segment whose bordered system is regular there.

    Parameters
    ----------
    segment : Segment
    test : Aim or callable
        Test function Solved -> float, with opposite signs at the two ends.
    tolerance : float
        Width of the final bracket relative to the segment.
    jump : float
        A test that changes by more than this over a tiny part of the segment counts as a jump; the root is then not continuous.

    Returns
    -------
    Root or None
        None if the ends do not bracket a zero or the segment cannot be solved.
    """
    if isinstance(test, Aim):
        hit = segment.engine.search(segment.way, test, tolerance, jump)
        if hit is None:
            return None
        if hit.point is not None:
            return Root(hit.place, hit.point, hit.error, hit.jump <= LOCATING.jump)
        # the zero could not be solved for again, as where equations are singular; the search below stores every point
    solved: dict[float, Solved] = {}

    def value(s: float) -> float:
        point = segment.at(s)
        if point is None:
            return math.nan
        solved[s] = point
        return float(test(point))

    fa, fb = value(0.0), value(1.0)
    if not (math.isfinite(fa) and math.isfinite(fb) and fa * fb <= 0.0):
        return None
    s, low, high, flow, fhigh = bracketed_root(value, 0.0, 1.0, fa, fb, tolerance, jump)
    width = abs(solved[high].p - solved[low].p) + 2.0 * EPSILON * abs(solved[s].p)
    error = max(width, solved[s].correction * LOCATING.halved)
    return Root(s, solved[s], error, abs(fhigh - flow) <= LOCATING.jump)


def bracketed_root(
    f: Callable[[float], float],
    a: float,
    b: float,
    fa: float,
    fb: float,
    tolerance: float = ROUNDED,
    jump: float = np.inf,
) -> tuple[float, float, float, float, float]:
    """Find a root of f between a and b; see :mod:`contvines.continuation.bracketing`.

    Parameters
    ----------
    f : callable
        May return NaN where it cannot be evaluated; a point nearby is then tried.
    a, b, fa, fb : float
        Bracket, and the values there: of opposite signs, or one of them zero.
    tolerance : float
        Width of the final bracket relative to the first one.
    jump : float
        Stop if f still changes by more than this over a bracket of 1e-5 of the first one: f has a jump there.

    Returns
    -------
    (root, low, high, f(low), f(high)) : tuple of float
        The best estimate and the final bracket.
    """
    from ..continuation.bracketing import Bracket  # the native core has its own

    bracket = Bracket(b, fb, 0.0, a, fa, 0.0, tolerance, jump)
    bracket.narrow(lambda x: (f(x), 0.0))
    (low, flow), (high, fhigh) = sorted(((bracket.x1, bracket.f1), (bracket.x2, bracket.f2)))
    return bracket.best, low, high, flow, fhigh


# ------------------------------------------------------------------ location at points with a singular bordered system
@cache
def chebyshev_nodes(n: int) -> np.ndarray:
    """Return the n roots of the Chebyshev polynomial T_n; for even n none of them is 0."""
    return np.cos((2.0 * np.arange(n) + 1.0) * np.pi / (2 * n))


@cache
def chebyshev_series(n: int) -> np.ndarray:
    """Return the matrix, shape (n, n), that maps values at ``chebyshev_nodes(n)`` to the coefficients of the Chebyshev series through them."""
    return np.linalg.inv(chebvander(chebyshev_nodes(n), n - 1))


def locate_singular(
    segment: Segment, test: Callable[[Solved], float], rough: float, width: float = 0.2
) -> Root | None:
    """Locate the zero of a test function at a branch point, where the bordered system is singular.

    Newton's method loses digits near a branch point. The branch is therefore solved at Chebyshev nodes on both sides of it, and the point and
    the test function are interpolated; the interpolation converges like (width/2)^8. Narrower windows are tried, too. If the segment is so short
    that the result is less accurate than `Settings.located`, wider windows are tried, which reach beyond the segment.

    Parameters
    ----------
    segment, test
        As for :func:`locate`.
    rough : float
        Approximate position.
    width : float
        Half width of the first window, relative to the segment.

    Returns
    -------
    Root or None
        None if no window contains a zero or its nodes cannot be solved.
    """
    engine = segment.engine
    roots = _in_windows(segment, test, rough, width * NARROWER)
    if not roots:
        return None
    best = min(roots, key=itemgetter(0))[1]
    if best.error > engine.settings.located * engine.parameter_unit(best.point.p):
        # the segment is so short that rounding dominates on all of it; nodes beyond its ends are better
        roots += _in_windows(segment, test, best.position, width * WIDER)
    roots.sort(key=itemgetter(0))
    best = roots[0][1]
    if len(roots) > 1 and engine.problem.scales is not None:
        # rounding dominates in all windows, and the smallest of their error estimates is small by chance
        disagreement = abs(roots[1][1].point.p - best.point.p)
        return best._replace(error=2.0 * max(best.error, roots[1][1].error, disagreement))
    return best


def _in_windows(
    segment: Segment, test: Callable[[Solved], float], rough: float, widths: np.ndarray
) -> list[tuple[float, Root]]:
    """Return (estimated error, root) from windows of the given half widths, until rounding makes the roots worse."""
    roots: list[tuple[float, Root]] = []
    for width in widths.tolist():
        root = _interpolated(segment, test, rough, width)
        if root is None:
            continue
        score = max(root.error, root.point.residual / segment.engine.size(root.point.u))
        roots.append((score, root))
        if score > min(roots, key=itemgetter(0))[0] or score < ROUNDED:
            break
        rough = root.position
    return roots


def _interpolated(
    segment: Segment, test: Callable[[Solved], float], rough: float, width: float
) -> Root | None:
    """Return the root by interpolation from the nodes of one window, or None."""
    engine, nodes, values = segment.engine, chebyshev_nodes(NODES), np.empty(NODES)
    points = [point for point in segment.several(rough + width * nodes) if point is not None]
    if len(points) < NODES:
        return None
    for i in np.argsort(np.abs(nodes)):
        # nearest to the singular point first: a test may choose its reference there
        values[i] = test(points[i])
    if not np.isfinite(values).all():
        return None
    parts = [np.array([getattr(p, name) for p in points]) for name in ("u", "p", "tangent", "row")]
    samples = np.column_stack(parts)
    finite = np.isfinite(samples).all(axis=0)
    f, series = (chebyshev_series(NODES) @ numbers for numbers in (values, np.where(finite, samples, 0.0)))
    grid = np.linspace(-1.2, 1.2, 49)
    on_grid = chebval(grid, f)
    changes = np.flatnonzero(on_grid[:-1] * on_grid[1:] <= 0.0)
    if not len(changes):
        return None
    i = int(changes[np.argmin(np.abs(grid[changes] + 0.025))])
    x = bracketed_root(lambda t: float(chebval(t, f)), *grid[i : i + 2], *on_grid[i : i + 2])[0]
    n, interpolated = engine.n, np.where(finite, chebval(x, series), np.inf)
    z, tangent, row = interpolated[: n + 1], interpolated[n + 1 : 2 * n + 2], interpolated[2 * n + 2 :]
    u, p = np.ascontiguousarray(z[:n]), float(z[n])
    residual = engine.residual(u, p)
    polished = engine.polish(u, p, segment.border, float(segment.border @ z), segment.direction)
    along, slope = series[:, n], abs(float(chebval(x, chebder(f))))
    error = float(np.abs(along[-2:]).sum())
    if slope > 0.0:
        error += float(np.abs(f[-2:]).sum() / slope * abs(chebval(x, chebder(along))))
    row = row if polished is None else polished.row
    return Root(rough + width * x, Solved(u, p, engine.unit(tangent), row, 0.0, residual, error), error)
