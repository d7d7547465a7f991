"""One pass over a chunk of points: lengths, margins, multipliers and symmetric parts, from which detection begins.

The native core does it for compiled problems (native/scan.hpp), numpy for others. Multipliers are taken one by one
(:func:`contvines.continuation.layout.multiplier`): the k-th largest real one is a test function of its own, so two that cross at once are two
events. A product of test functions would not change sign.
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

OPPOSITE = 0.9  # cosine of the angle between what is opposite, at least, but for the sign


class Spectra(NamedTuple):
    """Multipliers of n points.

    Attributes
    ----------
    near : ndarray, shape (n,)
        Distance of the positive real one that is nearest to the circle, as a logarithm (for flows of the real part from the axis); NaN where
        there is none, or one on the circle to rounding.
    past : ndarray, shape (3, n)
        How many are past the circle.
    """

    near: np.ndarray
    past: np.ndarray


class Scan(NamedTuple):
    """Of n points and the n - 1 segments between them, w margins and s symmetries.

    Attributes
    ----------
    lengths : ndarray, shape (n - 1,)
    smallest : ndarray, shape (n,)
        Smallest margins, infinity without margins.
    spectra : Spectra
    reached : ndarray, shape (n - 1,)
        Not 0 where a multiplier may have reached the circle between two points and gone back; see `reached`.
    low : ndarray, shape (w,)
        Not 0 for margins that a parabola through three neighbours may bring to zero: below the lowest of three points it falls by a part of the
        changes between them, at most a quarter of the square of the longer length over the shorter one.
    sizes : ndarray, shape (s, n)
        Largest entry of the part that each symmetry changes.
    turns : ndarray, shape (s, n - 1)
        Inner products of that part at both ends of segments: negative where it turns round.
    quiet : bool
        Whether it is known that slopes, signs, multipliers and margins leave nothing to look for; False where it was not asked.
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
    """Scans chunks of one problem's branches."""
    if engine.compiled and engine.plain and all(test.affine is not None for test in symmetries):
        return NativeScan(engine, symmetries)
    return partial(with_arrays, engine, symmetries)


def spectra(engine: Engine, rows: np.ndarray) -> Spectra:
    """What the multipliers of some rows tell."""
    with np.errstate(all="ignore"):
        sizes = sizes_by_sort(engine, rows)
        return Spectra(_nearest_of(sizes)[0], (sizes > LOCATING.past).sum(axis=2))


def _nearest_of(sizes: np.ndarray) -> np.ndarray:
    """The smallest sizes along the last axis; NaN where there are none, or one is rounding."""
    near = np.fmin.reduce(np.abs(sizes), axis=-1, initial=np.inf)
    return np.where((near > LOCATING.past) & (near < np.inf), near, np.nan)


def reached(engine: Engine, rows: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Segments between neighbouring rows on which a multiplier may have reached the circle (the axis) and gone back, shape (n - 1,).

    In the plane of logarithms the circle is a line, and so is the axis in that of eigenvalues.
    """
    return _dips(engine, rows, lengths) | _pairs_reached(engine, rows, lengths)


def _dips(engine: Engine, rows: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Segments beside points at which a parabola, through these and their two neighbours, says that a real multiplier passes the line and comes back.

    The parabola is that of the product of all distances from 1, and from -1 (of eigenvalues from 0), in parts of one plus the sizes: regular where two
    multipliers change places or become a pair, and hardly changed by those that are far away. So is that of the nearest one, as two that pass
    together leave the product positive. Those on the line to rounding are left out.
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
    """Segments on which one of a pair may have reached the line.

    A multiplier is the nearest one at the next point, be that real or one of a pair. It may have reached the line if it goes as far as both its
    places at the ends of the segment are from the line, together; on two sides it has passed. It goes as far as from one place to the other, or as `Locating.faster` times the largest of its rates on this segment and those
    beside it have it: rates towards the line, or, where two real ones become a pair on one of these, in any direction. On the line to rounding nothing tells.
    """
    m, kind = engine.m, engine.detection
    re, im = rows[:, : 2 * m : 2], rows[:, 1 : 2 * m : 2]
    if kind not in ("map", "flow") or not (im > 0.0).any():
        return np.zeros(len(lengths), dtype=bool)
    with np.errstate(all="ignore"):
        modulus = np.where(im == 0.0, np.abs(re), np.hypot(re, im))
        size = np.log(modulus) if kind == "map" else re
        place = np.array([size, re / modulus, im / modulus] if kind == "map" else [size, im])
        told, pairs = np.isfinite(place).all(axis=0) & (im >= 0.0), im > 0.0
        steps = place[:, 1:, None, :] - place[:, :-1, :, None]
        gaps = np.where(told[:-1, :, None] & told[1:, None, :], np.sqrt((steps**2).sum(axis=0)), np.inf)
        rates = gaps, np.abs(steps[0]), (pairs[:-1, :, None] != pairs[1:, None, :]) * lengths[:, None, None]
        links = [_nearest(gaps, np.array(rates) / lengths[:, None, None], axis) for axis in (2, 1)]
        nothing, found = np.zeros((3, 1, m)), np.zeros(len(lengths), dtype=bool)
        before = np.concatenate([nothing, links[1][1][:, :-1]], axis=1)
        behind = np.concatenate([links[0][1][:, 1:], nothing], axis=1)
        first, last = slice(-1), slice(1, None)
        for axis, (at, own), one, other, here, there in (
            (2, links[0], first, last, before, behind),
            (1, links[1], last, first, behind, before),
        ):
            a, b = np.abs(size[one]), np.abs(np.take_along_axis(size[other], at, 1))
            anyway, towards, born = np.fmax(np.fmax(own, here), np.take_along_axis(there, at[None], 2))
            gap, faster = (
                gaps.min(axis=axis),
                LOCATING.faster * lengths[:, None] * np.where(born > 0.0, anyway, towards),
            )
            sure = pairs[one] & (gap < np.inf) & (np.minimum(a, b) > LOCATING.past)
            found |= (sure & (np.fmax(gap, faster) >= a + b)).any(axis=1)
    return found


def _nearest(gaps: np.ndarray, numbers: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Of each multiplier at one end of segments which one at the other is the nearest, and some numbers of both, (k, n - 1, m); 0 where there is none."""
    at = gaps.argmin(axis=axis)
    found = np.take_along_axis(numbers, np.expand_dims(at, (0, axis + 1)), axis + 1).squeeze(axis + 1)
    return at, np.where(gaps.min(axis=axis) < np.inf, found, 0.0)


def with_arrays(engine: Engine, symmetries: Sequence[SymmetryTest], chunk: Chunk) -> Scan:
    """The reference."""
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
    """The same in the native core, for symmetries that are signed permutations."""

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
        places = 11 * n * self.engine.m  # room for those of multipliers
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


# ------------------------------------------------------------------ multipliers past the circle
def sizes_by_sort(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """How far past the circle multipliers are, shape (3, ..., m): real ones near 1, near -1, and complex pairs; NaN where they are of another sort.

    As logarithms; for flows real parts (there is nothing near -1). Where only branch points are looked for ("real") all count as real, so
    that a double one, which rounding makes a pair or two, counts twice either way.
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
    """How many multipliers are past the circle: real ones past 1, past -1, and complex pairs; shape (..., 3)."""
    return np.moveaxis((sizes_by_sort(engine, rows) > LOCATING.past).sum(axis=-1), 0, -1)


def balance(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Smallest number past the circle plus the largest before it, of the real multipliers of each row; 0 without both.

    Where one multiplier leaves while another enters at the same place, as at branch points with the symmetry of a triangle, no
    count changes, but this sum passes through zero.
    """
    size = sizes_by_sort(engine, rows)[0]
    past = np.where(size > 0.0, size, np.inf).min(axis=-1, initial=np.inf)
    before = np.where(size <= 0.0, size, -np.inf).max(axis=-1, initial=-np.inf)
    both = np.isfinite(past) & np.isfinite(before)
    return np.where(both, np.where(both, past, 0.0) + np.where(both, before, 0.0), 0.0)


def pairs_past(engine: Engine, rows: np.ndarray) -> np.ndarray:
    """Of eigenvalues that all count as real ones ("real"), how many are past the axis in pairs that rounding has not made; shape (...)."""
    re, im = rows[..., : 2 * engine.m : 2], np.abs(rows[..., 1 : 2 * engine.m : 2])
    unit = np.minimum(np.hypot(re, im).max(axis=-1, keepdims=True, initial=0.0), 1.0)
    return ((re > LOCATING.past) & (im > engine.settings.critical * unit)).sum(axis=-1)


def parabola_dips(
    left: np.ndarray, middle: np.ndarray, right: np.ndarray, h1: np.ndarray | float, h2: np.ndarray | float
) -> np.ndarray:
    """Whether the parabola through three positive values at such distances passes zero between them."""
    with np.errstate(all="ignore"):
        before, after = (middle - left) / h1, (right - middle) / h2
        bend, slope = (after - before) / (h1 + h2), (before * h2 + after * h1) / (h1 + h2)
        vertex = -0.5 * slope / bend
        found = (left > 0.0) & (middle > 0.0) & (right > 0.0) & (bend > 0.0) & (-h1 < vertex) & (vertex < h2)
        return found & (middle - 0.25 * slope * slope / bend < 0.0)


# ------------------------------------------------------------------ what a symmetry changes
@lru_cache(maxsize=64)
def _patternless(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Twice n numbers without a pattern, multiples of irrational numbers, and the order of the first ones."""
    probe, check = (0.1 + 0.8 * np.modf(np.sqrt(a) * np.arange(1.0, n + 1.0))[0] for a in (2.0, 3.0))
    return probe, check, np.argsort(probe, kind="stable")


def image_of(symmetry: Symmetry, u: np.ndarray, p: float) -> np.ndarray:
    """The image of a solution (u, p)."""
    image = symmetry.apply(u)
    return image if symmetry.offset is None else image + symmetry.offset(p)


class SymmetryTest:
    """The part of u that a symmetry changes: u - T(u), modulo the shift by a period, in units of the unknowns' scale.

    T is usually a signed permutation plus a constant; it is then found out once and applied to whole chunks. Where T depends on the
    parameter it is asked at each point. ``shift`` is not zero, ``scale`` not one all over: else they are None.
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
        """u - T(u) for points of shape (n, N) at parameter values of shape (n,)."""
        if self.affine is not None:
            order, signs, constant = self.affine
            gap = np.take(points, order, axis=1)  # of long branches a large array: worked on in place
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
        """Derivative of T at u applied to v."""
        if self.affine is not None:
            order, signs, _ = self.affine
            return signs * v[order]
        scale = CENTRAL / max(float(np.abs(v).max()), TINY)
        return (self.symmetry.apply(u + scale * v) - self.symmetry.apply(u - scale * v)) / (2.0 * scale)


def turns_round(test: SymmetryTest, parts: np.ndarray, least: float, accuracy: float = np.inf) -> bool:
    """Whether the part that a symmetry changes has turned round between two points, shape (2, N).

    Both are larger than noise; or all their many unknowns are opposite, as those of noise are not: of a cycle on a mesh, known to an accuracy, that has
    become one of half the period, or an equilibrium.
    """
    along = float(parts[0] @ parts[1])
    if not along < 0.0:
        return False
    smaller = np.abs(parts).max(axis=1).min()
    if smaller > least:
        return True
    opposite = along < -OPPOSITE * float(np.linalg.norm(parts[0]) * np.linalg.norm(parts[1]))
    return opposite and (test.kind == "hopf" or (test.kind == "period-doubling" and bool(smaller > accuracy)))
