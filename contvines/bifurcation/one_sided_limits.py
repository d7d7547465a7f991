"""One-sided limits: tangent and multipliers at a border, from points of the branch just before it.

Where something vanishes at a border (an impact's speed, a stick, a flight), the equations there may be singular, and what is
computed from their derivatives is rounding. The branch is smooth up to the border, though, and so are its tangent and the
coefficients of the characteristic polynomial of its multipliers: they are extrapolated. Where a multiplier grows without bound, as
at a wall that is touched without speed, the coefficients times the distance are.
"""

from __future__ import annotations

import math
from operator import sub

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine, Solved
from ..continuation.layout import solved_point
from ..shared.floating_point import TINY
from .locate import Root
from .segment import Segment
from .settings import LIMITS

BEYOND = 4.0  # times what has grown at the nearest of them: what is computed at the border is not the end of that growth
SPREAD = 4.0  # a margin differs by such a factor at least where its products with what grows as its inverse are compared
VANISHES = 0.1  # of the margin that does at the border: what it seems to be there, from points so near that rounding may stop its fall
CUBIC = np.array([4.0, -6.0, 4.0, -1.0])  # the value at 0 of the cubic through those at 1, 2, 3, 4
PLACES = (1.0, 2.0, 3.0, 4.0)
STRAYING = 0.5  # part of that distance by which a point before a short segment may be missed
GROWN = 2.0  # times a multiplier at four times the distance: it grows on towards the border
POLES = 2  # multipliers that grow without bound, at most
CONVERGED = (LIMITS.smooth, *[LIMITS.growing] * POLES)
EXTRAPOLATION = CUBIC * np.power.outer(PLACES, np.arange(POLES + 1)).T  # of values times powers of the place


@np.errstate(all="ignore")  # multipliers beside homoclinic orbits, and their products, are beyond all numbers
def one_sided(segment: Segment, root: Root) -> tuple[Solved, Solved | None]:
    """The point at a border, its tangent and multipliers replaced by their limits where they are rounding; and the point close to it."""
    engine, point, position = segment.engine, root.point, root.position
    reach = min(engine.settings.aside, position / 3.0)
    beside = [position - k * reach for k in (1.0, 2.0) if reach > 0.0]
    tells = engine.m > 0 and engine.problem.spectrum == "map" and segment.length > 0.0
    spacings = [distance / segment.length for distance in LIMITS.distances] if tells else []
    widest = next((step for step in spacings if position - PLACES[-1] * step >= -1.0), None)
    before = [] if widest is None else [position - k * widest for k in PLACES]
    short = position - engine.settings.close / segment.length if segment.length > 0.0 else 0.0
    # all in one call; the border itself is there for where there is nothing else
    found = segment.found([*beside, *before, short if short > 0.0 else position])
    known, split = (found.numbers[:, 1] >= 0.0).tolist(), len(beside)
    tangent, row, rows = point.tangent, point.row, found.rows[split:-1]
    if beside and all(known[:split]):
        tangent = _tangent(engine, tangent, *found.tangents[:split])
    if not all(known[split:-1]):
        rows = rows[:0]
    if tells and not _plainly(engine, row, rows):
        limits = _limits(segment, position, row)
        if limits is not None:
            m, roots, row = engine.m, _roots(limits), row.copy()
            row[: 2 * m].view(np.complex128)[:] = roots
        elif not np.isfinite(row[: 2 * engine.m]).all():
            row = _by_growth(segment, position, row)
    return point._replace(tangent=tangent, row=row), solved_point(found, -1) if short > 0.0 else None


def _tangent(engine: Engine, own: np.ndarray, near: np.ndarray, far: np.ndarray) -> np.ndarray:
    """The tangent, extrapolated from two before it where the one solved for is something else."""
    ahead = engine.unit(2.0 * near - far)
    return own if 1.0 - engine.inner(ahead, own) < LIMITS.tangent else ahead


def _plainly(engine: Engine, own: np.ndarray, rows: np.ndarray) -> bool:
    """Whether the polynomial tends to the one computed at the border by the first points (4, columns) already, as at most borders."""
    if not len(rows):
        return False
    numbers = own[: 2 * engine.m], CUBIC.dot(rows[:, : 2 * engine.m])
    if (
        _apart(*(one.tolist() for one in numbers)) < LIMITS.agreeing / engine.m
    ):  # where none meet, each is smooth
        return True
    polynomials = _characteristic(engine.spectrum(np.concatenate([own[None, :], rows])))
    return _apart(CUBIC.dot(polynomials[1:]).tolist(), polynomials[0].tolist()) < LIMITS.agreeing


def _limits(segment: Segment, position: float, own: np.ndarray) -> list[list[float]] | None:
    """Limits of the characteristic polynomial times powers of the distance, up to the first that is finite.

    None if none converges, or if they agree with the polynomial computed at the border (of the row `own`).
    """
    computed = _characteristic(segment.engine.spectrum(own)).tolist()
    limits = _extrapolated(segment, position).tolist()
    if not limits:
        return None
    best: list[list[float]] | None = None
    error = math.inf
    for i, limit in enumerate(limits):
        if _apart(limit[0], computed) < LIMITS.agreeing:
            return None
        if i > 0:  # compared with the spacing before
            changed = [_apart(one, other) for one, other in zip(limit, limits[i - 1])]
            poles = next((k for k, change in enumerate(changed) if change < CONVERGED[k]), POLES)
            fewer = best is not None and poles < len(best) - 1
            if changed[poles] < CONVERGED[poles] and (changed[poles] < error or fewer):
                best, error = limit[: poles + 1], changed[poles]
    if best is None:
        return _by_margin(segment, position, own)
    if len(best) == 1:
        return None if _apart(best[0], computed) < LIMITS.agreeing + 10.0 * error else best
    grown = max(map(abs, best[-1])) / LIMITS.nearest[-1] ** (len(best) - 1)
    if max(map(abs, computed)) > BEYOND * grown:
        return best
    return None if _bounded(segment, position, computed) else best


def _by_margin(segment: Segment, position: float, own: np.ndarray) -> list[list[float]] | None:
    """The polynomial, and its limit times the margin that vanishes, if that is the same wherever rounding has put the margin."""
    engine = segment.engine
    (_, beside), (_, before) = (
        _rows(segment, position, spacings) for spacings in (LIMITS.nearest, LIMITS.distances)
    )
    if not (len(beside) and len(before) and engine.problem.n_margins):
        return None
    rows = np.concatenate([own[None, :], beside.reshape(-1, len(own))])
    index = int(np.abs(engine.margins(own)).argmin())
    margins, polynomials = engine.margins(rows)[:, index], _characteristic(engine.spectrum(rows))
    products = margins[:, None] * polynomials
    grown = products[:, 1]
    if not np.isfinite(products).all() or np.abs(polynomials[0]).argmax() != 1:
        return None
    even = float(np.ptp(grown)) < LIMITS.growing * float(np.abs(grown).max())
    if not (even and float(np.abs(margins).max()) > SPREAD * float(np.abs(margins).min())):
        return None
    side = np.sign(engine.margins(before[0, 0])[index])
    return [polynomials[0].tolist(), (side * np.median(products, axis=0)).tolist()]


def _by_growth(segment: Segment, position: float, own: np.ndarray) -> np.ndarray:
    """The row with multipliers as they are nearest to the border, those that still grow there without bound.

    For borders at which more vanishes at once than powers of the distance are extrapolated, and nothing can be computed there.
    """
    _, rows = _rows(segment, position, LIMITS.distances)
    m = segment.engine.m
    if not len(rows) or not np.isfinite(rows[-1][:, : 2 * m]).all():
        return own
    near, far = (sorted(one, key=abs, reverse=True) for one in segment.engine.spectrum(rows[-1][[0, -1]]))
    roots = np.array(
        [
            LIMITS.unbounded * one / abs(one) if abs(one) > GROWN * max(1.0, abs(other)) else one
            for one, other in zip(near, far)
        ]
    )
    row = own.copy()
    row[: 2 * m].view(np.complex128)[:] = roots
    return row


def _extrapolated(segment: Segment, position: float) -> np.ndarray:
    """The polynomials times each power of the distance, extrapolated to the border from each spacing that tells, (k, powers, m + 1)."""
    spacings, rows = _rows(segment, position, LIMITS.distances)
    polynomials = _characteristic(segment.engine.spectrum(rows))
    sure = np.isfinite(polynomials).all(axis=(1, 2))
    powers = spacings[sure, None] ** np.arange(POLES + 1)
    return powers[:, :, None] * (EXTRAPOLATION @ polynomials[sure])


def _bounded(segment: Segment, position: float, computed: list[float]) -> bool:
    """Whether what grows on the way to the border stops growing at the very end, and becomes what is computed there.

    As where another impact, before the one that is about to graze, is almost as slow. Nearer than rounding lets the vanishing margin
    come to zero nothing grows any more, and nothing can be determined.
    """
    largest = max(map(abs, computed))
    _, rows = _rows(segment, position, LIMITS.nearest)
    polynomials = _characteristic(segment.engine.spectrum(rows))
    for margins, values in zip(segment.engine.smallest_margin(rows), polynomials):
        if not abs(CUBIC @ margins) < VANISHES * abs(margins[0]):
            return False
        if not np.isfinite(values).all():
            continue
        if not np.abs(values).max() <= (1.0 + LIMITS.growing) * largest:
            return False  # what is computed at the border is something else
        if _apart(CUBIC.dot(values).tolist(), computed) < LIMITS.growing:
            return True
    return False


def _apart(one: list[float], other: list[float]) -> float:
    """Largest difference of two polynomials (m + 1,), as a part of their largest coefficient; infinite where they are."""
    if not all(map(math.isfinite, one + other)):
        return math.inf
    gap = max(map(abs, map(sub, one, other)))
    return gap / max(map(abs, one + other)) if gap > 0.0 else 0.0


def _rows(segment: Segment, position: float, spacings: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Rows of multipliers and margins at four points before the border, and the spacings (k,) for which all are found, (k, 4, columns)."""
    wanted = np.array(spacings)
    places = position - np.outer(wanted / segment.length, PLACES)
    rows, found = segment.rows(places.reshape(-1))
    rows, found = rows.reshape(*places.shape, -1), found.reshape(places.shape)
    for i, j in zip(*(places < -1.0).nonzero()):
        point = _before(segment, float(places[i, j]))
        found[i, j] = point is not None
        rows[i, j] = 0.0 if point is None else point.row
    known = found.all(axis=1)
    return wanted[known], rows[known]


def _before(segment: Segment, s: float) -> Solved | None:
    """The point at s, before the segment: a branch that begins beside its border has no points further away."""
    engine, a, distance = segment.engine, segment.a, -s * segment.length
    if distance > LIMITS.straight:
        return None
    guess = segment.za - distance * a.tangent
    found = engine.across(guess[:-1], float(guess[-1]), a.tangent)
    if found is None or engine.norm(engine.join(found.u, found.p) - guess) > STRAYING * distance:
        return None
    return found


def _characteristic(spectrum: np.ndarray) -> np.ndarray:
    """Coefficients of the polynomials with these zeros (..., m), highest power first, shape (..., m + 1)."""
    m = spectrum.shape[-1]
    coefficients: NDArray[np.complex128] = np.zeros((*spectrum.shape[:-1], m + 1), dtype=np.complex128)
    coefficients[..., 0] = 1.0
    for k in range(m):
        coefficients[..., 1 : k + 2] -= spectrum[..., k : k + 1] * coefficients[..., : k + 1]
    return coefficients.real


def _roots(limits: list[list[float]]) -> NDArray[np.complex128]:
    """The multipliers, largest modulus first; those that grow without bound have a size of `LIMITS.unbounded`."""
    poles = len(limits) - 1
    finite = sorted(_zeros(limits[poles][poles:]), key=lambda one: (-abs(one), -one.real, -one.imag))
    # beside the border these are roots of x^k + c_1 x^(k-1) + ..., over the distance
    growing = _zeros([limits[k][k] for k in range(poles + 1)])
    growing = [LIMITS.unbounded * one / max(abs(one), TINY) for one in growing]
    missing = len(limits[0]) - 1 - len(growing) - len(finite)
    return np.array([*growing, *finite, *[0.0] * missing], dtype=np.complex128)


def _zeros(polynomial: list[float]) -> list[complex]:
    """Zeros of a polynomial; of one or two in closed form."""
    degree, lead = len(polynomial) - 1, polynomial[0]
    if degree > 2 or lead == 0.0:
        return np.roots(polynomial).tolist()
    if degree < 2:
        return [complex(-one / lead) for one in polynomial[1:]]
    b, c = polynomial[1] / lead, polynomial[2] / lead
    square = 0.25 * b * b - c
    if square < 0.0:
        whole = complex(-0.5 * b, math.sqrt(-square))
        return [whole, whole.conjugate()]
    larger = -0.5 * b - math.copysign(math.sqrt(square), b)
    return [complex(larger), complex(c / larger if larger else 0.0)]
