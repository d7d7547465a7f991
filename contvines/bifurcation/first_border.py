"""Borders: locate where a branch stops being real (or becomes real again), and find the vanishing margin, the tangent and the multipliers there.

If an event vanishes at a border (an impact's speed, the duration of a stick or flight), the equations may be singular there, and
numbers computed from their derivatives are rounding. But the branch is smooth up to the border, and so are its tangent and the
coefficients of the characteristic polynomial of its multipliers; these are extrapolated. If a multiplier grows without bound, as
at a graze of a wall, the coefficients times the distance to the border are extrapolated.
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

# error of a border's parameter value
MARGIN_ROUNDING = 2.0 * EPSILON  # rounding of margins, in units of the machine's size
BEND_AT = 0.1  # position of the sample that gives the curvature of a margin, relative to the point close before the border
SCATTER_AT = 0.05, 0.03, 0.02, 0.01, 0.005  # positions of the samples that show the scatter of a margin
SIGNIFICANT = 10.0  # a difference of margins is more than rounding from this many MARGIN_ROUNDING on
SAFETY = 10.0  # safety factor of an error estimated from a few samples
ORDER = {name: i for i, name in enumerate(BORDERS)}  # rank of the kinds of borders that are met at once

# limits of tangent and multipliers
UNBOUNDED = 4.0  # growth is unbounded if the value at the border exceeds this many times the one expected at the nearest sample
SPREAD = 4.0  # factor by which margins must differ at least, where their products with growing coefficients are compared
VANISHES = 0.1  # the extrapolated margin must be below this part of its nearest sample; else rounding has stopped its fall
CUBIC = np.array([4.0, -6.0, 4.0, -1.0])  # weights of values at PLACES in the cubic's value at 0
PLACES = np.array([1.0, 2.0, 3.0, 4.0])  # distances of the samples from the border, in units of the spacing
LARGEST_MISS = 0.5  # largest error of a point before a short segment, relative to its distance from it
GROWN = 2.0  # a multiplier grows without bound if it is this many times the one at four times the distance
POLES = 2  # largest number of multipliers that grow without bound
CONVERGED = (LIMITS.smooth, *[LIMITS.growing] * POLES)  # tolerances, by number of growing multipliers
EXTRAPOLATION = CUBIC * np.power.outer(PLACES, np.arange(POLES + 1)).T  # the same times powers of PLACES


def border_of(segment: Segment, real: bool) -> tuple[Located | None, Solved | None]:
    """Return the border of a segment, and the point close before it; None for each that does not exist.

    Parameters
    ----------
    segment : Segment
    real : bool
        Whether its beginning has positive margins. Then the border is the first zero of a margin; else it is the point from which
        all margins are positive again.
    """
    engine = segment.engine
    a, b = (end.row[2 * engine.m :] < MARGIN for end in (segment.a, segment.b))  # False for NaN
    if real:
        falling = (b & ~a).nonzero()[0]
    else:
        falling = np.arange(len(a) if a.any() and not b.any() else 0)
    root = first_zero(segment, falling, real) if len(falling) else None
    if root is None:
        return None, None
    if not real:
        # a margin that is zero to rounding all along hides the return of those that were negative
        returning = first_zero(segment, a.nonzero()[0], real)
        if returning is not None and engine.smallest_margin(returning.point.row) >= MARGIN:
            root = returning
    elif len(falling) > 1:
        still_negative = _negative_behind(segment, root, falling)
        if len(still_negative) < len(falling):
            other_root = first_zero(segment, still_negative, real)
            if other_root is not None and engine.margins(other_root.point.row)[falling].min() >= MARGIN:
                root, falling = other_root, still_negative
    index = _vanishing_margin(engine, engine.margins(root.point.row), falling)
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
    """Locate the zero of the smallest of the chosen margins (indices)."""
    # if the ends do not have opposite signs after all, a real branch ends at the end with the smaller margin
    margin = Aim(MARGINS, 2 * segment.engine.m + chosen, anyway=int(real))
    root = locate(segment, margin)
    if root is None or root.position > 0.0 or not margin(root.point) < 0.0:
        return root
    # the segment begins behind the border, by a margin within rounding; where the margin is flat the parameter may differ visibly
    settings = segment.engine.settings
    ahead = segment.at(min(1.0, max(settings.aside, settings.close / segment.length)))
    fall = 0.0 if ahead is None else margin(root.point) - margin(ahead)
    if ahead is None or not fall > 0.0:
        return root
    return root._replace(error=abs(margin(root.point) / fall * (ahead.p - root.point.p)))


def _negative_behind(segment: Segment, root: Root, falling: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return those of the margins `falling` (indices) that are negative just behind a border.

    If a cycle repeats itself at the border, for example where a stick vanishes in every other round, the margins of the other
    rounds touch zero there and become positive again. They may be negative at the end of the segment for other reasons.
    """
    at_border = segment.engine.margins(root.point.row)[falling]
    settings = segment.engine.settings
    for step in (settings.aside, 10.0 * settings.aside):
        point = segment.at(root.position + step)
        if point is not None:
            behind = segment.engine.margins(point.row)[falling]
            negative = falling[(behind < MARGIN) & (at_border <= at_border.min() + np.sqrt(settings.tied))]
            if len(negative):
                return negative
    return falling


def _rounding(segment: Segment, root: Root, index: int, before: Solved | None) -> float:
    """Return the error of a border's parameter value from rounding of the margins that vanish there, and of its unknowns.

    A flat margin is zero to rounding far beyond the final bracket of the root search. The error then is the distance, in the parameter, to the points
    at which it exceeds rounding. `before` is the point close before the border, if it is known.
    """
    first, place, point = 2 * segment.engine.m, root.position, root.point
    margins = point.row[first:]
    sloped = segment.engine.settings.close  # distance at which a margin's slope can be measured
    flat = np.abs(margins) < SIGNIFICANT * MARGIN_ROUNDING
    flat[index] = True
    flat = flat.nonzero()[0]
    at_border, error = _finite(margins[flat]), 0.0
    towards = -1.0 if place * segment.length > sloped else 1.0
    room = place if towards < 0.0 else 1.0 - place
    reach = min(sloped / segment.length, room)
    neighbour = before if towards < 0.0 else segment.at(place + reach)
    if neighbour is not None and reach < room:
        error = _scatter(segment, root, index, towards * reach, neighbour)
    while reach > 0.0 and (neighbour := neighbour or segment.at(place + towards * reach)) is not None:
        rises, distance = np.abs(_finite(neighbour.row[first:][flat]) - at_border), abs(neighbour.p - point.p)
        significant = rises > SIGNIFICANT * MARGIN_ROUNDING
        if significant.any():
            error = max(error, distance * MARGIN_ROUNDING / float(rises[significant].min()))
            flat, at_border = flat[~significant], at_border[~significant]
        if not len(flat):
            break
        if reach == room:
            error = max(error, distance)
            break
        reach, neighbour = min(30.0 * reach, room), None
    return error


def _scatter(segment: Segment, root: Root, index: int, reach: float, neighbour: Solved) -> float:
    """Return the error of a border's parameter value from unknowns that have lost digits, as where two events coincide.

    These show in the margin's samples close before the border, as scatter around the parabola through the border and two points farther away, on which
    a smooth margin lies. Returns 0 if the margin jumps at the border.
    """
    j = 2 * segment.engine.m + index
    points = segment.several([root.position + part * reach for part in (BEND_AT, *SCATTER_AT)])
    found = [float(point.row[j] - root.point.row[j]) for point in (neighbour, *points) if point is not None]
    rises, fractions = np.array(found), np.array(SCATTER_AT)
    if len(rises) < 2 + len(fractions) or not np.isfinite(rises).all():
        return 0.0
    if not (np.abs(rises[2:]) < 0.5 * abs(rises[0])).all():
        return 0.0
    bend = (rises[1] / BEND_AT - rises[0]) / (BEND_AT - 1.0)
    deviation = float(np.abs(rises[2:] - fractions * (rises[0] + (fractions - 1.0) * bend)).max())
    return SAFETY * deviation / abs(rises[0]) * abs(neighbour.p - root.point.p)


def _finite(margins: np.ndarray) -> np.ndarray:
    """Return margins in which infinite ones and NaN are replaced by 1."""
    return np.where(np.isfinite(margins), margins, 1.0)


def _vanishing_margin(engine: Engine, margins: np.ndarray, falling: NDArray[np.intp]) -> int:
    """Return the index of the margin that vanishes.

    Several margins vanish at once if, for example, a stick disappears; rounding then decides which one is smallest. Therefore those within
    `Settings.tied` of the smallest one count as equal, and the order of their kinds (`ORDER`) decides.
    """
    tied = falling[margins[falling] <= margins[falling].min() + engine.settings.tied]
    kinds = [engine.problem.margin_kind(int(j)) for j in tied]
    return int(tied[min(range(len(tied)), key=lambda i: (ORDER.get(kinds[i], len(ORDER)), i))])


@np.errstate(all="ignore")  # multipliers beside homoclinic orbits, and their products, overflow
def one_sided(segment: Segment, root: Root) -> tuple[Solved, Solved | None]:
    """Return the point at a border, with tangent and multipliers replaced by their one-sided limits if they are rounding; and the point close before it."""
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
    """Return the limits at a border of the characteristic polynomial times powers 0, 1, ... of the distance, up to the first that is finite.

    None if no limit converges, or if the polynomial computed at the border (from the row `own`) is right, as at most borders.
    """
    computed = _characteristic(segment.engine.spectrum(own)).tolist()
    best: list[list[float]] | None = None
    error, last, any_finite = math.inf, list[list[float]](), False
    for spacing, rows in _samples(segment, position, LIMITS.distances):
        polynomials = _characteristic(segment.engine.spectrum(rows))
        if not np.isfinite(polynomials).all():
            continue
        any_finite = True
        powers = spacing ** np.arange(POLES + 1)
        limit = (powers[:, None] * (EXTRAPOLATION @ polynomials)).tolist()
        if _polynomial_difference(limit[0], computed) < LIMITS.agreeing:
            return None
        # change from the spacing before
        changed = [_polynomial_difference(one, other) for one, other in zip(limit, last)] or [math.inf] * (
            POLES + 1
        )
        poles = next((k for k, change in enumerate(changed) if change < CONVERGED[k]), POLES)
        fewer = best is not None and poles < len(best) - 1
        if changed[poles] < CONVERGED[poles] and (changed[poles] < error or fewer):
            best, error = limit[: poles + 1], changed[poles]
        last = limit
    if best is None:
        return _by_margin(segment, position, own) if any_finite else None
    if len(best) == 1:
        return None if _polynomial_difference(best[0], computed) < LIMITS.agreeing + 10.0 * error else best
    growth = max(map(abs, best[-1])) / LIMITS.nearest[-1] ** (len(best) - 1)
    if max(map(abs, computed)) > UNBOUNDED * growth:
        return best
    return None if _bounded(segment, position, computed) else best


def _by_margin(segment: Segment, position: float, own: np.ndarray) -> list[list[float]] | None:
    """Return the polynomial and the limit of its product with the vanishing margin, if this product is constant for all sizes of the margin, else None."""
    engine = segment.engine
    before_border = [rows for _, rows in _samples(segment, position, LIMITS.nearest)]
    _, before = next(_samples(segment, position, LIMITS.distances))
    if not (before_border and engine.problem.n_margins):
        return None
    rows = np.concatenate([own[None, :], *before_border])
    index = int(np.abs(engine.margins(own)).argmin())
    margins, polynomials = engine.margins(rows)[:, index], _characteristic(engine.spectrum(rows))
    products = margins[:, None] * polynomials
    second = products[:, 1]
    if not np.isfinite(products).all() or np.abs(polynomials[0]).argmax() != 1:
        return None
    even = float(np.ptp(second)) < LIMITS.growing * float(np.abs(second).max())
    if not (even and float(np.abs(margins).max()) > SPREAD * float(np.abs(margins).min())):
        return None
    side = np.sign(engine.margins(before[0])[index])
    return [polynomials[0].tolist(), (side * np.median(products, axis=0)).tolist()]


def _by_growth(segment: Segment, position: float, own: np.ndarray) -> np.ndarray:
    """Return the row with the multipliers of the nearest points to the border; those that still grow there get the size `LIMITS.unbounded`.

    Used if the row computed at the border is not finite and more events vanish at once than `POLES` allows for.
    """
    m, nearest = segment.engine.m, [rows for _, rows in _samples(segment, position, LIMITS.distances)][-1:]
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
    """Whether coefficients that grow towards the border stop growing very near to it, and reach the values computed there.

    Example: another impact, before the one that is about to graze, is almost as slow. Returns False if rounding keeps the vanishing margin from
    reaching zero, as the growth stops there for this reason.
    """
    largest = max(map(abs, computed))
    for _, rows in _samples(segment, position, LIMITS.nearest):
        margins, values = segment.engine.smallest_margin(rows), _characteristic(segment.engine.spectrum(rows))
        if not abs(CUBIC @ margins) < VANISHES * abs(margins[0]):
            return False
        if not np.isfinite(values).all():
            continue
        if not np.abs(values).max() <= (1.0 + LIMITS.growing) * largest:
            return False  # the polynomial exceeds the one computed at the border
        if _polynomial_difference(CUBIC.dot(values).tolist(), computed) < LIMITS.growing:
            return True
    return False


def _polynomial_difference(one: list[float], other: list[float]) -> float:
    """Return the largest difference of two polynomials, shape (m + 1,), relative to their largest coefficient; inf if one is not finite."""
    if not all(map(math.isfinite, one + other)):
        return math.inf
    gap = max(map(abs, map(sub, one, other)))
    return gap / max(map(abs, one + other)) if gap > 0.0 else 0.0


def _samples(
    segment: Segment, position: float, spacings: tuple[float, ...]
) -> Iterator[tuple[float, np.ndarray]]:
    """Generate (spacing, rows of multipliers and margins at four points before the border, shape (4, columns)), if all four are solved.

    If the branch begins next to its border, points farther away are sought before the segment, along its tangent.
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
                engine.norm(engine.join(point.u, point.p) - guess) <= LARGEST_MISS * distance
            )
            if point is not None:
                rows[j] = point.row
        if found.all():
            yield spacing, rows


def _characteristic(spectrum: np.ndarray) -> np.ndarray:
    """Return the coefficients of the polynomials with these zeros, shape (..., m): highest power first, shape (..., m + 1)."""
    m = spectrum.shape[-1]
    coefficients: NDArray[np.complex128] = np.zeros((*spectrum.shape[:-1], m + 1), dtype=np.complex128)
    coefficients[..., 0] = 1.0
    for k in range(m):
        coefficients[..., 1 : k + 2] -= spectrum[..., k : k + 1] * coefficients[..., : k + 1]
    return coefficients.real


def _roots(limits: list[list[float]]) -> NDArray[np.complex128]:
    """Return the multipliers from limits of the polynomial; those that grow without bound come first, with the size `LIMITS.unbounded`."""
    poles = len(limits) - 1
    finite = sorted(_zeros(limits[poles][poles:]), key=lambda one: (-abs(one), -one.real, -one.imag))
    # near the border the growing ones are the roots of x^k + c_1 x^(k-1) + ... divided by the distance
    growing = _zeros([limits[k][k] for k in range(poles + 1)])
    growing = [LIMITS.unbounded * one / max(abs(one), TINY) for one in growing]
    missing = len(limits[0]) - 1 - len(growing) - len(finite)
    return np.array([*growing, *finite, *[0.0] * missing], dtype=np.complex128)


def _zeros(polynomial: list[float]) -> list[complex]:
    """Return the zeros of a polynomial; in closed form up to degree two."""
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
