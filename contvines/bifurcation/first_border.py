"""Borders: where on a segment a branch ceases to be real (or becomes so again), which margin says so, and tangent and multipliers there.

Where something vanishes at a border (an impact's speed, a stick, a flight), the equations there may be singular, and what is
computed from their derivatives is rounding. The branch is smooth up to the border, though, and so are its tangent and the
coefficients of the characteristic polynomial of its multipliers: they are extrapolated. Where a multiplier grows without bound, as
at a wall that is touched without speed, the coefficients times the distance are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from operator import sub

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine, Solved
from ..continuation.layout import MARGIN, MARGINS, Aim
from ..shared.numbers import EPSILON, TINY
from .kinds import BORDERS
from .locate import Located, Role, Root, Segment, locate
from .settings import LIMITS

MARGIN_ROUNDING = 2.0 * EPSILON  # of margins, in units of the machine's own size
BENT = 0.1  # part of the distance of the point close before a border at which its margin tells a bend
NEARER = 0.05, 0.03, 0.02, 0.01, 0.005  # parts of it at which unknowns that are known to few digits show
TOLD = 10.0  # times that: a difference of margins which is no rounding
SEEN = 10.0  # times an error that is seen in a few samples: what is stated
ORDER = {name: i for i, name in enumerate(BORDERS)}  # of borders that are met at once

BEYOND = 4.0  # times what has grown at the nearest of them: what is computed at the border is not the end of that growth
SPREAD = 4.0  # a margin differs by such a factor at least where its products with what grows as its inverse are compared
VANISHES = 0.1  # of the margin that does at the border: what it seems to be there, from points so near that rounding may stop its fall
CUBIC = np.array([4.0, -6.0, 4.0, -1.0])  # the value at 0 of the cubic through those at 1, 2, 3, 4
PLACES = np.array([1.0, 2.0, 3.0, 4.0])
STRAYING = 0.5  # part of that distance by which a point before a short segment may be missed
GROWN = 2.0  # times a multiplier at four times the distance: it grows on towards the border
POLES = 2  # multipliers that grow without bound, at most
CONVERGED = (LIMITS.smooth, *[LIMITS.growing] * POLES)
EXTRAPOLATION = CUBIC * np.power.outer(PLACES, np.arange(POLES + 1)).T  # of values times powers of the place


def border_of(segment: Segment, real: bool) -> tuple[Located | None, Solved | None]:
    """The border of a segment, and the point close before it; None where there is none.

    Parameters
    ----------
    segment : Segment
    real : bool
        Whether its beginning has positive margins: the border is where the first one vanishes; else where all are positive again.
    """
    engine = segment.engine
    a, b = (end.row[2 * engine.m :] < MARGIN for end in (segment.a, segment.b))  # not of what is no number
    if real:
        falling = (b & ~a).nonzero()[0]
    else:
        falling = np.arange(len(a) if a.any() and not b.any() else 0)
    root = first_zero(segment, falling, real) if len(falling) else None
    if root is None:
        return None, None
    if not real:
        # another margin that is zero to rounding all along hides where those that were negative come back
        own = first_zero(segment, a.nonzero()[0], real)
        if own is not None and engine.smallest_margin(own.point.row) >= MARGIN:
            root = own
    elif len(falling) > 1:
        passing = _passing(segment, root, falling)
        if len(passing) < len(falling):
            again = first_zero(segment, passing, real)
            if again is not None and engine.margins(again.point.row)[falling].min() >= MARGIN:
                root, falling = again, passing
    index = _which(engine, engine.margins(root.point.row), falling)
    point, before = one_sided(segment, root)
    found = Located(
        root.position,
        point,
        engine.problem.margin_kind(index),
        index,
        Role.BORDER,
        root.error,
        rounding=_rounding(segment, root, index, before),
    )
    return found, before


def first_zero(segment: Segment, chosen: NDArray[np.intp], real: bool) -> Root | None:
    """Where the smallest of the chosen margins passes zero."""
    # where the ends do not have opposite signs after all, a real branch ends at the end at which they are smallest
    margin = Aim(MARGINS, 2 * segment.engine.m + chosen, anyway=int(real))
    root = locate(segment, margin)
    if root is None or root.position > 0.0 or not margin(root.point) < 0.0:
        return root
    # the segment begins behind the border, by what counts as rounding: where the margin is flat that may be seen in the parameter
    settings = segment.engine.settings
    ahead = segment.at(min(1.0, max(settings.aside, settings.close / segment.length)))
    fall = 0.0 if ahead is None else margin(root.point) - margin(ahead)
    if ahead is None or not fall > 0.0:
        return root
    return root._replace(error=abs(margin(root.point) / fall * (ahead.p - root.point.p)))


def _passing(segment: Segment, root: Root, falling: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of the margins that are negative just behind a border.

    Of a cycle that repeats itself at the border, as where a stick vanishes in every other round, the margins of the other
    rounds touch zero there, and come back; that they are negative at the end of the segment is another matter.
    """
    here = segment.engine.margins(root.point.row)[falling]
    settings = segment.engine.settings
    for step in (settings.aside, 10.0 * settings.aside):
        point = segment.at(root.position + step)
        if point is not None:
            there = segment.engine.margins(point.row)[falling]
            passing = falling[(there < MARGIN) & (here <= here.min() + np.sqrt(settings.tied))]
            if len(passing):
                return passing
    return falling


def _rounding(segment: Segment, root: Root, index: int, before: Solved | None) -> float:
    """How far rounding of the margins that vanish at a border, and of its unknowns, may move its parameter value.

    Where a margin is flat it is zero, but for rounding, far from the last bracket; of one that is that all along nobody knows where it
    passes zero. The point close before the border may be known.
    """
    first, place, point = 2 * segment.engine.m, root.position, root.point
    margins = point.row[first:]
    sloped = segment.engine.settings.close  # from here on the slope of a margin can be told
    flat = np.abs(margins) < TOLD * MARGIN_ROUNDING
    flat[index] = True
    flat = flat.nonzero()[0]
    here, error = _finite(margins[flat]), 0.0
    towards = -1.0 if place * segment.length > sloped else 1.0
    room = place if towards < 0.0 else 1.0 - place
    reach = min(sloped / segment.length, room)
    aside = before if towards < 0.0 else segment.at(place + reach)
    if aside is not None and reach < room:
        error = _scatter(segment, root, index, towards * reach, aside)
    while reach > 0.0 and (aside := aside or segment.at(place + towards * reach)) is not None:
        rises, moved = np.abs(_finite(aside.row[first:][flat]) - here), abs(aside.p - point.p)
        told = rises > TOLD * MARGIN_ROUNDING
        if told.any():
            error = max(error, moved * MARGIN_ROUNDING / float(rises[told].min()))
            flat, here = flat[~told], here[~told]
        if not len(flat):
            break
        if reach == room:
            error = max(error, moved)
            break
        reach, aside = min(30.0 * reach, room), None
    return error


def _scatter(segment: Segment, root: Root, index: int, reach: float, aside: Solved) -> float:
    """How far unknowns that are not known to the last digits, as where two events fall together, may move the parameter value of a border.

    They show in the margin, close before the border, as its distance from the parabola through the border and two points farther away: a
    smooth margin lies on it. Of a margin that jumps at the border nothing is said.
    """
    j = 2 * segment.engine.m + index
    points = segment.several([root.position + part * reach for part in (BENT, *NEARER)])
    found = [float(point.row[j] - root.point.row[j]) for point in (aside, *points) if point is not None]
    rises, nearer = np.array(found), np.array(NEARER)
    if len(rises) < 2 + len(nearer) or not np.isfinite(rises).all():
        return 0.0
    if not (np.abs(rises[2:]) < 0.5 * abs(rises[0])).all():
        return 0.0
    bend = (rises[1] / BENT - rises[0]) / (BENT - 1.0)
    apart = float(np.abs(rises[2:] - nearer * (rises[0] + (nearer - 1.0) * bend)).max())
    return SEEN * apart / abs(rises[0]) * abs(aside.p - root.point.p)


def _finite(margins: np.ndarray) -> np.ndarray:
    """Margins, those that do not apply or have no bound as large ones."""
    return np.where(np.isfinite(margins), margins, 1.0)


def _which(engine: Engine, margins: np.ndarray, falling: NDArray[np.intp]) -> int:
    """The margin that vanishes. Several may, as when a stick disappears: which one is smallest is then a matter of

    rounding, so those that are as small as the smallest one count as equal, and the order of kinds decides.
    """
    tied = falling[margins[falling] <= margins[falling].min() + engine.settings.tied]
    kinds = [engine.problem.margin_kind(int(j)) for j in tied]
    return int(tied[min(range(len(tied)), key=lambda i: (ORDER.get(kinds[i], len(ORDER)), i))])


@np.errstate(all="ignore")  # multipliers beside homoclinic orbits, and their products, are beyond all numbers
def one_sided(segment: Segment, root: Root) -> tuple[Solved, Solved | None]:
    """The point at a border, its tangent and multipliers replaced by their limits where they are rounding; and the point close to it."""
    engine, point, position = segment.engine, root.point, root.position
    tangent, row, m, before = point.tangent, point.row, engine.m, None
    reach = min(engine.settings.aside, position / 3.0)
    if reach > 0.0:
        near, far = segment.several((position - reach, position - 2.0 * reach))
        if near is not None and far is not None:
            ahead = engine.unit(2.0 * near.tangent - far.tangent)
            if not 1.0 - engine.inner(ahead, tangent) < LIMITS.tangent:
                tangent = ahead
    if segment.length > 0.0:
        if m > 0 and engine.problem.spectrum == "map":
            limits = _limits(segment, position, row)
            if limits is not None:
                row = row.copy()
                row[: 2 * m].view(np.complex128)[:] = _roots(limits)
            elif not np.isfinite(row[: 2 * m]).all():
                row = _by_growth(segment, position, row)
        short = position - engine.settings.close / segment.length
        before = segment.at(short) if short > 0.0 else None
    return point._replace(tangent=tangent, row=row), before


def _limits(segment: Segment, position: float, own: np.ndarray) -> list[list[float]] | None:
    """Limits of the characteristic polynomial times powers of the distance, up to the first that is finite.

    None if none converges, or if they agree with the polynomial computed at the border (of the row `own`), as at most borders.
    """
    computed = _characteristic(segment.engine.spectrum(own)).tolist()
    best: list[list[float]] | None = None
    error, last, known = math.inf, list[list[float]](), False
    for spacing, rows in _before(segment, position, LIMITS.distances):
        polynomials = _characteristic(segment.engine.spectrum(rows))
        if not np.isfinite(polynomials).all():
            continue
        known = True
        powers = spacing ** np.arange(POLES + 1)
        limit = (powers[:, None] * (EXTRAPOLATION @ polynomials)).tolist()
        if _apart(limit[0], computed) < LIMITS.agreeing:
            return None
        # compared with the spacing before
        changed = [_apart(one, other) for one, other in zip(limit, last)] or [math.inf] * (POLES + 1)
        poles = next((k for k, change in enumerate(changed) if change < CONVERGED[k]), POLES)
        fewer = best is not None and poles < len(best) - 1
        if changed[poles] < CONVERGED[poles] and (changed[poles] < error or fewer):
            best, error = limit[: poles + 1], changed[poles]
        last = limit
    if best is None:
        return _by_margin(segment, position, own) if known else None
    if len(best) == 1:
        return None if _apart(best[0], computed) < LIMITS.agreeing + 10.0 * error else best
    grown = max(map(abs, best[-1])) / LIMITS.nearest[-1] ** (len(best) - 1)
    if max(map(abs, computed)) > BEYOND * grown:
        return best
    return None if _bounded(segment, position, computed) else best


def _by_margin(segment: Segment, position: float, own: np.ndarray) -> list[list[float]] | None:
    """The polynomial, and its limit times the margin that vanishes, if that is the same wherever rounding has put the margin."""
    engine = segment.engine
    beside = [rows for _, rows in _before(segment, position, LIMITS.nearest)]
    _, before = next(_before(segment, position, LIMITS.distances))
    if not (beside and engine.problem.n_margins):
        return None
    rows = np.concatenate([own[None, :], *beside])
    index = int(np.abs(engine.margins(own)).argmin())
    margins, polynomials = engine.margins(rows)[:, index], _characteristic(engine.spectrum(rows))
    products = margins[:, None] * polynomials
    grown = products[:, 1]
    if not np.isfinite(products).all() or np.abs(polynomials[0]).argmax() != 1:
        return None
    even = float(np.ptp(grown)) < LIMITS.growing * float(np.abs(grown).max())
    if not (even and float(np.abs(margins).max()) > SPREAD * float(np.abs(margins).min())):
        return None
    side = np.sign(engine.margins(before[0])[index])
    return [polynomials[0].tolist(), (side * np.median(products, axis=0)).tolist()]


def _by_growth(segment: Segment, position: float, own: np.ndarray) -> np.ndarray:
    """The row with multipliers as they are nearest to the border, those that still grow there without bound.

    For borders at which more vanishes at once than powers of the distance are extrapolated, and nothing can be computed there.
    """
    m, nearest = segment.engine.m, [rows for _, rows in _before(segment, position, LIMITS.distances)][-1:]
    if not nearest or not np.isfinite(nearest[0][:, : 2 * m]).all():
        return own
    near, far = (sorted(one, key=abs, reverse=True) for one in segment.engine.spectrum(nearest[0][[0, -1]]))
    row = own.copy()
    row[: 2 * m].view(np.complex128)[:] = [
        LIMITS.unbounded * one / abs(one) if abs(one) > GROWN * max(1.0, abs(other)) else one
        for one, other in zip(near, far)
    ]
    return row


def _bounded(segment: Segment, position: float, computed: list[float]) -> bool:
    """Whether what grows on the way to the border stops growing at the very end, and becomes what is computed there.

    As where another impact, before the one that is about to graze, is almost as slow. Nearer than rounding lets the vanishing margin
    come to zero nothing grows any more, and nothing can be determined.
    """
    largest = max(map(abs, computed))
    for _, rows in _before(segment, position, LIMITS.nearest):
        margins, values = segment.engine.smallest_margin(rows), _characteristic(segment.engine.spectrum(rows))
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


def _before(
    segment: Segment, position: float, spacings: tuple[float, ...]
) -> Iterator[tuple[float, np.ndarray]]:
    """Spacings, and the rows of multipliers and margins at four points before the border (4, columns), where all are found.

    A branch that begins beside its border has no points further away: they are looked for before the segment, along its tangent.
    """
    engine, a = segment.engine, segment.a
    for spacing in spacings:
        places = position - spacing / segment.length * PLACES
        rows, found = segment.rows(places)
        for j in np.flatnonzero(places < -1.0):
            distance = -float(places[j]) * segment.length
            guess = segment.za - distance * a.tangent
            point = (
                engine.across(guess[:-1], float(guess[-1]), a.tangent)
                if distance <= LIMITS.straight
                else None
            )
            found[j] = point is not None and (
                engine.norm(engine.join(point.u, point.p) - guess) <= STRAYING * distance
            )
            if point is not None:
                rows[j] = point.row
        if found.all():
            yield spacing, rows


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
