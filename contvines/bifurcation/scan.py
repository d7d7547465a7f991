"""Scan: one pass over a chunk of points that computes lengths, margins, counts of multipliers and asymmetric parts; detection begins with these.

The native core scans chunks of compiled problems (native/scan.hpp), numpy those of others. The k-th largest real multiplier is a test function of
its own (:func:`contvines.continuation.layout.multiplier`), so that two multipliers that cross at once give two events; a product of test functions
would not change sign there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, lru_cache, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..continuation.engine import Engine
from ..continuation.layout import KINDS, MARGIN, Chunk
from ..core.library import NUMBER, POINTER, WHOLE, address, function
from ..core.table import pack, place
from ..shared.numbers import CENTRAL, TINY
from .settings import LOCATING

if TYPE_CHECKING:
    from ..problems.protocol import Symmetry

OPPOSITE = 0.9  # two vectors are opposite if the cosine of their angle is below minus this


class Spectra(NamedTuple):
    """Multipliers of n points, in short.

    Attributes
    ----------
    near : ndarray, shape (n,)
        |log| of the positive real multiplier nearest to the circle (for flows: |eigenvalue| of the real one nearest to the axis); NaN without
        such a multiplier, or with one on the circle to rounding.
    past : ndarray, shape (3, n)
        Numbers of multipliers outside the circle: real ones past 1, real ones past -1, complex pairs.
    """

    near: np.ndarray
    past: np.ndarray


class Scan(NamedTuple):
    """Result of a scan of n points and the n - 1 segments between them, with w margins and s symmetries.

    Attributes
    ----------
    lengths : ndarray, shape (n - 1,)
        Lengths of the segments in the metric.
    smallest : ndarray, shape (n,)
        Smallest margin of each point, inf without margins.
    spectra : Spectra
    reached : ndarray, shape (n - 1,)
        Not 0 if a multiplier may have reached the circle between the two points and returned; see `reached`.
    low : ndarray, shape (w,)
        Not 0 for margins that may dip to zero. The test is a cheap bound: the parabola through three neighbouring points falls below the lowest of
        them by at most a quarter of the square of the longer length over the shorter one, times the larger of the changes between them.
    sizes : ndarray, shape (s, n)
        Largest entry of the asymmetric part u - T(u) of each symmetry T.
    turns : ndarray, shape (s, n - 1)
        Inner product of the asymmetric parts at both ends of each segment: negative if the part turns round.
    quiet : bool
        True if slopes, signs, multipliers and margins certainly show no special point; False if there may be one, or this was not tested.
    """

    lengths: np.ndarray
    smallest: np.ndarray
    spectra: Spectra
    reached: np.ndarray
    low: np.ndarray
    sizes: np.ndarray
    turns: np.ndarray
    quiet: bool = False


def scanner(engine: Engine, symmetries: Sequence[SymmetryTest]) -> Callable[[Chunk], Scan]:
    """Return a function that scans chunks of one problem's branches: in the native core if possible."""
    if engine.compiled and engine.plain and all(test.affine is not None for test in symmetries):
        return NativeScan(engine, symmetries)
    return partial(with_arrays, engine, symmetries)


def spectra(engine: Engine, rows: np.ndarray) -> Spectra:
    """Return the summary of the multipliers of n rows."""
    with np.errstate(all="ignore"):
        sizes = sizes_by_sort(engine, rows)
        return Spectra(_nearest_of(sizes)[0], (sizes > LOCATING.past).sum(axis=2))


def _nearest_of(sizes: np.ndarray) -> np.ndarray:
    """Return the smallest absolute sizes along the last axis; NaN without finite ones, or if the smallest is rounding."""
    near = np.fmin.reduce(np.abs(sizes), axis=-1, initial=np.inf)
    return np.where((near > LOCATING.past) & (near < np.inf), near, np.nan)


def reached(engine: Engine, rows: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Find the segments on which a multiplier may have reached the circle (the axis) and returned, shape (n - 1,).

    The tests use logarithms of multipliers, for which the circle is a straight line, and eigenvalues as they are; "the line" below is either.

    Parameters
    ----------
    engine : Engine
    rows : ndarray, shape (n, columns)
        Multipliers and margins of consecutive points.
    lengths : ndarray, shape (n - 1,)
        Distances between these points.
    """
    return _dips(engine, rows, lengths) | _pairs_reached(engine, rows, lengths)


def _dips(engine: Engine, rows: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Find the segments on which, by parabolas through three neighbouring points, a real multiplier may cross the line and return.

    Two functions are tested:

    * the product of all |m - 1| / (1 + |m|), and of all |m + 1| / (1 + |m|) (of eigenvalues |m| / (1 + |m|)): smooth where two multipliers
      exchange ranks or become a pair, and hardly influenced by those far away;
    * the distance of the nearest real multiplier, as two that cross together leave the product positive.

    Multipliers on the line to rounding are left out.
    """
    found = np.zeros(len(lengths), dtype=bool)
    if engine.detection == "none" or not engine.m or len(lengths) < 2:
        return found
    re, im = rows[:, : 2 * engine.m : 2], rows[:, 1 : 2 * engine.m : 2]
    places = (1.0, -1.0) if engine.detection == "map" else (0.0,)
    with np.errstate(all="ignore"):
        sizes = sizes_by_sort(engine, rows)[: len(places)]
        parts = np.array([np.hypot(re - place, im) for place in places]) / (1.0 + np.hypot(re, im))
        products = np.log(np.where(parts > LOCATING.past, parts, 1.0)).sum(axis=2)
        logs = np.concatenate([products, np.log(_nearest_of(sizes))])
        past = np.tile((sizes > LOCATING.past).sum(axis=2), (2, 1))
        left, right = np.exp(logs[:, :-2] - logs[:, 1:-1]), np.exp(logs[:, 2:] - logs[:, 1:-1])
        one_side = (past[:, :-2] == past[:, 1:-1]) & (past[:, 2:] == past[:, 1:-1])
        dips = parabola_dips(left, np.ones_like(left), right, lengths[:-1], lengths[1:])
    dips = (dips & one_side).any(axis=0)
    found[:-1] |= dips
    found[1:] |= dips
    return found


def _pairs_reached(engine: Engine, rows: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Find the segments on which a multiplier of a complex pair may have reached the line.

    A multiplier is identified with the nearest one at the next point, which may be real. It may have reached the line if the distance that it may
    travel on the segment is at least the sum of its distances from the line at both ends. This distance is the larger of two numbers:

    * the distance between its positions at the ends;
    * `Locating.faster` times the largest rate on this segment and its two neighbours, times the length. Rates count towards the line only, but in any
      direction if two real multipliers become a pair on one of these segments.

    A multiplier on the line to rounding is not tested.
    """
    m, kind = engine.m, engine.detection
    re, im = rows[:, : 2 * m : 2], rows[:, 1 : 2 * m : 2]
    if kind not in ("map", "flow") or not (im > 0.0).any():
        return np.zeros(len(lengths), dtype=bool)
    with np.errstate(all="ignore"):
        modulus = np.where(im == 0.0, np.abs(re), np.hypot(re, im))
        size = np.log(modulus) if kind == "map" else re
        place = np.array([size, re / modulus, im / modulus] if kind == "map" else [size, im])
        finite, pairs = np.isfinite(place).all(axis=0) & (im >= 0.0), im > 0.0
        steps = place[:, 1:, None, :] - place[:, :-1, :, None]
        gaps = np.where(finite[:-1, :, None] & finite[1:, None, :], np.sqrt((steps**2).sum(axis=0)), np.inf)
        rates = gaps, np.abs(steps[0]), (pairs[:-1, :, None] != pairs[1:, None, :]) * lengths[:, None, None]
        links = [_nearest(gaps, np.array(rates) / lengths[:, None, None], axis) for axis in (2, 1)]
        nothing, found = np.zeros((3, 1, m)), np.zeros(len(lengths), dtype=bool)
        before = np.concatenate([nothing, links[1][1][:, :-1]], axis=1)
        behind = np.concatenate([links[0][1][:, 1:], nothing], axis=1)
        first, last = slice(-1), slice(1, None)
        for axis, (at, own), one, other, one_side, other_side in (
            (2, links[0], first, last, before, behind),
            (1, links[1], last, first, behind, before),
        ):
            a, b = np.abs(size[one]), np.abs(np.take_along_axis(size[other], at, 1))
            anyway, towards, meets_real = np.fmax(
                np.fmax(own, one_side), np.take_along_axis(other_side, at[None], 2)
            )
            gap, faster = (
                gaps.min(axis=axis),
                LOCATING.faster * lengths[:, None] * np.where(meets_real > 0.0, anyway, towards),
            )
            testable = pairs[one] & (gap < np.inf) & (np.minimum(a, b) > LOCATING.past)
            found |= (testable & (np.fmax(gap, faster) >= a + b)).any(axis=1)
    return found


def _nearest(gaps: np.ndarray, numbers: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """For each multiplier at one end of the segments, return the index of the nearest one at the other end, and the numbers of this couple.

    Parameters
    ----------
    gaps : ndarray, shape (n - 1, m, m)
        Distances; infinite for multipliers that are left out.
    numbers : ndarray, shape (k, n - 1, m, m)
        k numbers of each couple.
    axis : int
        Axis of the other end: 2 or 1.

    Returns
    -------
    (ndarray of int, shape (n - 1, m), ndarray, shape (k, n - 1, m))
        The numbers are 0 without a nearest multiplier.
    """
    at = gaps.argmin(axis=axis)
    found = np.take_along_axis(numbers, np.expand_dims(at, (0, axis + 1)), axis + 1).squeeze(axis + 1)
    return at, np.where(gaps.min(axis=axis) < np.inf, found, 0.0)


def with_arrays(engine: Engine, symmetries: Sequence[SymmetryTest], chunk: Chunk) -> Scan:
    """Scan a chunk with numpy; the reference of the native core's scan."""
    steps = np.diff(np.column_stack([chunk.points, chunk.values]), axis=0)
    margins = chunk.rows[:, 2 * engine.m :]
    gaps = [test.part(chunk.points, chunk.values) for test in symmetries]
    lengths = np.sqrt((steps**2) @ engine.weights)
    with np.errstate(all="ignore"):
        uneven = lengths[1:] / lengths[:-1]
        part = 0.5 * np.fmax(uneven, 1.0 / uneven)[:, None] ** 2
        size, change = np.abs(margins), np.abs(np.diff(margins, axis=0))
        least = np.fmin(np.fmin(size[:-2], size[1:-1]), size[2:]) + MARGIN
        most = np.fmax(change[:-1], change[1:])
        return Scan(
            lengths,
            engine.smallest_margin(chunk.rows),
            spectra(engine, chunk.rows),
            reached(engine, chunk.rows, lengths),
            np.asarray(((least < part * most) & (most < np.inf)).any(axis=0)),
            np.array([np.abs(gap).max(axis=1, initial=0.0) for gap in gaps]),
            np.array([np.einsum("ij,ij->i", gap[1:], gap[:-1]) for gap in gaps]),
        )


class NativeScan:
    """Scan of chunks in the native core, for symmetries that are signed permutations plus a constant."""

    def __init__(self, engine: Engine, symmetries: Sequence[SymmetryTest]) -> None:
        self.engine, k, n = engine, len(symmetries), engine.n
        affine = [test.affine for test in symmetries if test.affine is not None]
        self.kept = (
            np.array([order for order, _, _ in affine], np.int64),
            np.array([sign for _, sign, _ in affine], float),
            np.array([constant for _, _, constant in affine], float),
            np.zeros(n) if engine.shift is None else engine.shift,
            np.empty((2, k, n)),
        )
        metric = float(engine.metric.of_unknowns), float(engine.metric.of_parameter)
        self.frame = pack(n, engine.row_size, engine.m, KINDS[engine.detection], k, *metric, *self.kept)
        self.symmetries, self.margins = k, engine.row_size - 2 * engine.m

    def __call__(self, chunk: Chunk) -> Scan:
        """Scan a chunk."""
        n, k, w = len(chunk), self.symmetries, self.margins
        places = 11 * n * self.engine.m  # work space for multipliers
        found = np.empty(10 * n - 2 + w + k * (2 * n - 1) + places)
        quiet = _native()(
            address(self.frame), n, self.engine.upright(float(chunk.values[0])), place(chunk.points), place(chunk.values),
            place(chunk.tangents), place(chunk.rows), place(chunk.signs), address(found),
        )  # fmt: skip
        near, past, low = 2 * n - 1, 6 * n - 1, 10 * n - 2
        sizes, turns = low + w, low + w + k * n
        return Scan(
            found[: n - 1],
            found[n - 1 : 2 * n - 1],
            Spectra(found[near : near + n], found[past : past + 3 * n].reshape(3, n)),
            found[past + 3 * n : low],
            found[low:sizes],
            found[sizes:turns].reshape(k, n),
            found[turns : turns + k * (n - 1)].reshape(k, n - 1),
            bool(quiet),
        )


@cache
def _native() -> Callable[..., int]:
    return function("core_scan", WHOLE, POINTER, WHOLE, NUMBER, *[POINTER] * 6)


# ------------------------------------------------------------------ multipliers outside the circle
def sizes_by_sort(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Return by how much multipliers are outside the circle, by sort: positive real, negative real, complex pairs; shape (3, ..., m).

    The numbers are log|m|, for flows the real parts (the second sort is then empty); NaN for multipliers of another sort. For problems with branch
    points only ("real") all eigenvalues count as real: a double one, which rounding may split into a pair, then always counts twice.
    """
    re, im, kind = rows[..., : 2 * engine.m : 2], rows[..., 1 : 2 * engine.m : 2], engine.detection
    with np.errstate(all="ignore"):
        real = im == 0.0
        if kind == "map":
            size = np.log(np.where(real | np.isnan(re), np.abs(re), np.hypot(re, im)))
            sorts = real & (re > 0.0), real & (re <= 0.0), im > 0.0
        else:
            size, none = re, np.zeros_like(real)
            sorts = (
                (real, none, im > 0.0) if kind == "flow" else (np.full_like(real, kind == "real"), none, none)
            )
        return np.where(np.array(sorts), size, np.nan)


def counts(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Return the numbers of multipliers outside the circle: real ones past 1, past -1, and complex pairs; shape (..., 3)."""
    return np.moveaxis((sizes_by_sort(engine, rows) > LOCATING.past).sum(axis=-1), 0, -1)


def balance(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Return, for the real multipliers of each row, the smallest positive log|m| plus the largest negative one; 0 without both.

    Where one multiplier leaves the circle while another enters, as at branch points with the symmetry of a triangle, no
    count changes, but this sum crosses zero.
    """
    size = sizes_by_sort(engine, rows)[0]
    past = np.where(size > 0.0, size, np.inf).min(axis=-1, initial=np.inf)
    before = np.where(size <= 0.0, size, -np.inf).max(axis=-1, initial=-np.inf)
    both = np.isfinite(past) & np.isfinite(before)
    return np.where(both, np.where(both, past, 0.0) + np.where(both, before, 0.0), 0.0)


def pairs_past(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Return the number of eigenvalues right of the axis in complex pairs that are more than rounding, for "real" problems; shape (...)."""
    re, im = rows[..., : 2 * engine.m : 2], np.abs(rows[..., 1 : 2 * engine.m : 2])
    unit = np.minimum(np.hypot(re, im).max(axis=-1, keepdims=True, initial=0.0), 1.0)
    return ((re > LOCATING.past) & (im > engine.settings.critical * unit)).sum(axis=-1)


def parabola_dips(
    left: np.ndarray, middle: np.ndarray, right: np.ndarray, h1: np.ndarray | float, h2: np.ndarray | float
) -> np.ndarray:
    """Whether the parabola through three positive values, at distances h1 and h2, dips below zero between them."""
    with np.errstate(all="ignore"):
        before, after = (middle - left) / h1, (right - middle) / h2
        bend, slope = (after - before) / (h1 + h2), (before * h2 + after * h1) / (h1 + h2)
        vertex = -0.5 * slope / bend
        found = (left > 0.0) & (middle > 0.0) & (right > 0.0) & (bend > 0.0) & (-h1 < vertex) & (vertex < h2)
        return found & (middle - 0.25 * slope * slope / bend < 0.0)


# ------------------------------------------------------------------ the asymmetric part of a solution
@lru_cache(maxsize=64)
def _patternless(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return two vectors of n irregular numbers in [0.1, 0.9], and the sorting order of the first one."""
    probe, check = (0.1 + 0.8 * np.modf(np.sqrt(a) * np.arange(1.0, n + 1.0))[0] for a in (2.0, 3.0))
    return probe, check, np.argsort(probe, kind="stable")


def image_of(symmetry: Symmetry, u: np.ndarray, p: float) -> np.ndarray:
    """Return the image of a solution (u, p) under a symmetry."""
    image = symmetry.apply(u)
    return image if symmetry.offset is None else image + symmetry.offset(p)


class SymmetryTest:
    """Test function for a symmetry T: the asymmetric part u - T(u), modulo the shift by a period, in units of the unknowns' scale.

    T is usually a signed permutation plus a constant. This is detected once, and T then applied to whole chunks (`affine` is its order, signs
    and constant). If T depends on the parameter it is evaluated at each point.

    Parameters
    ----------
    symmetry : Symmetry
    n : int
        Number of unknowns.
    shift : ndarray, shape (n,), optional
        Change of the unknowns by a shift of one period; None if zero.
    scale : ndarray, shape (n,), optional
        Typical sizes of the unknowns; None if all are one.
    """

    def __init__(
        self, symmetry: Symmetry, n: int, shift: np.ndarray | None, scale: np.ndarray | None = None
    ) -> None:
        self.symmetry, self.kind = symmetry, symmetry.kind
        self.shift, self.scale = shift, scale
        probe, check, places = _patternless(n)
        self.affine: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        if symmetry.offset is not None:
            return
        try:
            constant = np.asarray(symmetry.apply(np.zeros(n)), dtype=float)
            image = np.asarray(symmetry.apply(probe), dtype=float) - constant
            order = np.empty(n, dtype=int)
            order[np.argsort(np.abs(image), kind="stable")] = places
            signs = np.sign(image)
            wrong = np.abs(signs * check[order] + constant - symmetry.apply(check)).max()
            if np.abs(signs * probe[order] - image).max() < LOCATING.rounding and wrong < LOCATING.rounding:
                self.affine = (order, signs, constant)
        except (ArithmeticError, ValueError, IndexError):
            self.affine = None

    def part(self, points: np.ndarray, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """Return u - T(u), shape (n, N), for points of shape (n, N) at parameter values of shape (n,)."""
        if self.affine is not None:
            order, signs, constant = self.affine
            gap = np.take(points, order, axis=1)  # may be large: changed in place
            gap *= signs
            gap += constant
            np.subtract(points, gap, out=gap)
        else:
            gap = points - np.array([image_of(self.symmetry, u, float(p)) for u, p in zip(points, values)])
        if self.shift is not None:
            turns = np.rint(gap.dot(self.shift) / self.shift.dot(self.shift))
            if turns.any():
                gap = gap - turns[:, None] * self.shift
        return gap if self.scale is None else gap / self.scale

    def image_direction(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the derivative of T at u, applied to v."""
        if self.affine is not None:
            order, signs, _ = self.affine
            return signs * v[order]
        scale = CENTRAL / max(float(np.abs(v).max()), TINY)
        return (self.symmetry.apply(u + scale * v) - self.symmetry.apply(u - scale * v)) / (2.0 * scale)


def turns_round(test: SymmetryTest, parts: np.ndarray, least: float, accuracy: float = np.inf) -> bool:
    """Whether the asymmetric part has turned round between two points.

    Both parts must be larger than noise. Smaller ones count if their directions are nearly opposite in all unknowns, unlike noise, where a cycle on a
    mesh becomes one of half the period, or an equilibrium.

    Parameters
    ----------
    test : SymmetryTest
    parts : ndarray, shape (2, N)
        Asymmetric parts at the two points.
    least : float
        Largest entry from which a part is larger than noise.
    accuracy : float
        Accuracy of a cycle on a mesh; inf for other problems.
    """
    along = float(parts[0] @ parts[1])
    if not along < 0.0:
        return False
    smaller = np.abs(parts).max(axis=1).min()
    if smaller > least:
        return True
    opposite = along < -OPPOSITE * float(np.linalg.norm(parts[0]) * np.linalg.norm(parts[1]))
    return opposite and (test.kind == "hopf" or (test.kind == "period-doubling" and bool(smaller > accuracy)))
