"""Consistency: check that signs and counts at the two ends of a segment agree with the special points found between them.

Along one branch

* the parameter's direction changes at folds,
* the sign of det [[F_u, F_p], [tangent]] changes at branch points of odd multiplicity and where the branch meets its own image,
* the number of multipliers outside the circle (right of the axis) changes by one at folds, branch points and flips, by two at pairs.

Neighbouring branches have opposite signs of the determinant, so this check also finds a step that jumped from one branch to another; it is
traced again with shorter steps (:mod:`contvines.branches.tracing`). Any other inconsistent segment is halved until its parts are consistent, or as
short as `Settings.resolution`; the graph then marks it as unresolved.

For the tangent t, det [[F_u, F_p], [t]] = det(F_u) t.t / t_p: the sign of the left side, which is stored with every point, gives the sign of
det(F_u). It has the accuracy of an elimination with pivots; an eigenvalue can be less accurate if others are very much larger.

A matrix M is regular, and its determinant has one sign, for all errors of its entries up to E if the spectral radius of |M^-1| E is
below one (Rump, Linear Multilinear Algebra 47 (2000) 1, theorem 1.1; with E a multiple of |M| the radius is the componentwise condition
number of Bauer and Skeel, which does not depend on scales of rows and columns). Otherwise the sign may be rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..continuation.engine import Engine, Solved
from ..problems.abilities import Doubtful
from ..shared.numbers import EPSILON
from .locate import Located, Role, Root, Segment
from .location_error import rounding_of_parameter, singular_within
from .scan import pairs_past
from .settings import LOCATING

#: for each sort of multipliers (plus, minus, pair): the kinds of points at which one of them crosses the circle
PASSED_AT = (
    ("fold", "branch-point"),
    ("period-doubling", "symmetry-breaking"),
    ("neimark-sacker", "hopf"),
)
ROUNDING = 32.0 * EPSILON  # assumed relative error of the entries of F_u and F_p
SPECTRUM_ERROR = 10.0  # assumed error of the other multipliers at a special point, in units of the critical one's distance from the circle


def has_unexplained_change(segment: Segment, found: Sequence[Located]) -> bool:
    """Whether the numbers of multipliers outside the circle change by more than the points found on the segment explain.

    Real multipliers may pass through infinity, or change from past +1 to past -1 by way of complex pairs, without crossing the circle. A change
    counts only if the total number outside changes, or the number past +1 changes by an odd number.

    Parameters
    ----------
    segment : Segment
    found : sequence of Located
        Special points found on it.
    """
    engine = segment.engine
    before, after = segment.counts
    if engine.detection == "map" and not engine.adaptive and _count_differs(segment, found):
        return True
    plus, minus, pairs = (b - a for a, b in zip(before, after))
    if engine.detection == "real" and plus and plus % 2 == 0:
        ends = pairs_past(engine, np.array([segment.a.row, segment.b.row]))
        plus -= int(ends[1] - ends[0])  # a pair has crossed the axis; only branch points are sought here
    side = turned(segment.a, segment.b)
    if engine.scaled and engine.signed and abs(plus) == 1 and side is False:
        plus = 0  # the determinant contradicts the count: rounding
    if plus and engine.adaptive and segment.a.sign == segment.b.sign:
        rounded = max(rounding_of_parameter(engine, end) for end in (segment.a, segment.b))
        if abs(segment.b.p - segment.a.p) <= 2.0 * rounded:
            plus = 0  # the ends are nearer to each other than rounding
    if max(abs(end.tangent[-1]) for end in (segment.a, segment.b)) <= engine.upright(segment.a.p):
        plus = 0  # upright branch: the parameter's component of the tangent is zero, and with it det(F_u)
    if not engine.scaled and engine.detection == "map" and side is not None and plus % 2 != side:
        # det(F_u) keeps its sign if a multiplier passes through infinity, as where an event of a virtual orbit grazes
        short = segment.length <= 2.0 * engine.settings.resolution
        return not (minus == -plus and pairs == 0 and (short or segment.through_infinity()))
    explained = [sum(e.kind in kinds for e in found) for kinds in PASSED_AT]
    explained[0] += sum(e.astray for e in found)
    missing = any(abs(change) > number for change, number in zip((plus, minus, pairs), explained))
    if not (missing and (plus + minus + 2 * pairs != 0 or plus % 2 == 1)):
        return False
    # two multipliers that have crossed +1 may meet as a pair and be past -1 at the end
    odd = all(change % 2 == number % 2 for change, number in zip((plus, minus), explained))
    all_counted = bool(found) and all(_count_outside(engine, event) is not None for event in found)
    return not (engine.adaptive and odd and all_counted and not _count_differs(segment, found))


def _count_differs(segment: Segment, found: Sequence[Located]) -> bool:
    """Whether the number of multipliers outside the circle changes between the points found, so that a point is missing.

    From one end to the other, only the critical multipliers of each point found may cross the circle, at this point. Counts at the two ends are
    not enough: a pair may leave the circle between a period doubling and a fold and split on the real axis, or the multiplier that crosses +1 at a
    fold continues through infinity and returns through -1.
    """
    passed = [_count_outside(segment.engine, event) for event in sorted(found, key=lambda e: e.position)]
    if not passed:
        return False
    first, last = ({plus + minus + 2 * pairs} for plus, minus, pairs in segment.counts)
    marginal = any(
        on_circle(segment.engine, point, segment.engine.settings.critical) for point in (segment.a, segment.b)
    )
    outside = first
    for crossing in passed:
        if crossing is None:
            return False
        others, critical, certainly = crossing
        reached = {beyond for n in others for beyond in (n, n + critical) if {n, n + critical} & outside}
        if certainly and not marginal:
            reached = {2 * n + critical - total for n in others for total in outside & {n, n + critical}}
        outside = reached
    return not outside & last


def _count_outside(engine: Engine, event: Located) -> tuple[range, int, bool] | None:
    """Count the multipliers at a special point: critical ones, and others that may be outside the circle.

    The distance of the critical multipliers from the circle, zero in theory, measures how accurate the others are.

    Returns
    -------
    others : range
        Possible numbers of other multipliers outside the circle.
    own : int
        Number of critical multipliers: 2 for a pair, else 1.
    certainly : bool
        Whether these are critical to the accuracy of the settings.

    None for points of other kinds.
    """
    sort = next((k for k, kinds in enumerate(PASSED_AT) if event.kind in kinds), None)
    if sort is None or event.kind == "branch-point" or event.astray or not engine.m:
        return None
    spectrum, critical = engine.spectrum(event.point.row), 2 if sort == 2 else 1
    gaps = np.abs(np.abs(spectrum) - 1.0) if sort == 2 else np.abs(spectrum - (1.0, -1.0)[sort])
    if sort == 2:
        gaps[spectrum.imag == 0.0] = np.inf
    order = np.argsort(gaps)
    sizes, reached = np.abs(spectrum[order[critical:]]), float(gaps[order[0]])
    within = max(SPECTRUM_ERROR * reached, LOCATING.past)
    certain, possible = (int(np.count_nonzero(sizes > 1.0 + side)) for side in (within, -within))
    return range(certain, possible + 1), critical, reached <= engine.settings.critical


def on_circle(engine: Engine, point: Solved, within: float) -> bool:
    """Whether a multiplier is so near to the circle that counts of multipliers outside are unreliable."""
    return bool(np.any(np.abs(np.abs(engine.spectrum(point.row)) - 1.0) <= within))


def at_one(engine: Engine, event: Located) -> bool:
    """Whether a multiplier is +1 at a point. At a fold it is, unless an event of a virtual orbit grazes there."""
    spectrum = engine.spectrum(event.point.row)
    return bool(np.abs(spectrum - 1.0).min(initial=1.0) <= engine.settings.critical)


def unresolved(segment: Segment, middle: Solved) -> Located:
    """Return a mark in the middle of a segment that is not halved any more although it is inconsistent."""
    ends = (segment.a.p, segment.b.p)
    error = 0.5 * abs(ends[1] - ends[0])
    return Located(0.5, middle, role=Role.UNRESOLVED, error=error, bracket=ends)


def branch_jump(segment: Segment, found: list[Located]) -> Located | None:
    """Return a mark at the start of the segment if its ends lie on different branches, an unresolved mark if it is too short to decide, else None.

    Parameters
    ----------
    segment : Segment
    found : list of Located
        Special points found on it, in order; positions in [0, 1].
    """
    stop = next((i for i, e in enumerate(found) if e.ends_branch), len(found))
    short = segment.length <= segment.engine.settings.resolution
    changed = _sign_unaccounted(segment, found, stop)
    if not changed and (short or not any(is_inexact(segment, e) for e in found[: stop + 1])):
        return None
    if short:
        middle = segment.at(0.5)
        return None if middle is None else unresolved(segment, middle)
    return Located(0.0, segment.a, role=Role.LEAP)


def is_inexact(segment: Segment, event: Located) -> bool:
    """Whether a special point could not be located accurately, a sign that it does not exist."""
    if event.role is Role.UNRESOLVED:
        return False
    unit = segment.engine.parameter_unit(event.point.p)
    noise, scaled = segment.engine.noise, segment.engine.problem.scales is not None
    least = max(segment.engine.settings.located, LOCATING.noisy * noise)
    solved = segment.engine.settings.exact if scaled and not noise and event.kind == "branch-point" else least
    vague = event.error > 10.0 * least * unit
    if vague and event.kind == "branch-point":
        # compare with the accuracy that rounding of its matrix allows
        point = event.point
        vague = event.error > singular_within(segment.engine, point.u, point.p, point.tangent)
    if event.astray or vague:
        return True
    residual = event.point.residual  # engine.size is at least one: it is computed only for a large residual
    return residual > solved and residual > solved * segment.engine.size(event.point.u)


def _sign_unaccounted(segment: Segment, found: list[Located], stop: int) -> bool:
    """Whether the sign of the determinant changes before the branch ends although no branch point or meeting was found."""
    if any(e.kind == "branch-point" or e.role is Role.MEETING for e in found[: stop + 1]):
        return False
    last = segment.b if stop == len(found) else found[stop].point
    if not segment.a.sign * last.sign < 0.0:
        return False
    # an end may itself be singular (a stick of duration zero), its sign rounding: compare points beside the ends
    reach = 1.0 if stop == len(found) else found[stop].position
    inset = segment.engine.settings.aside
    inner = segment.several([share * reach for share in (inset, 1.0 - inset)])
    if inner[0] is not None and inner[1] is not None and not inner[0].sign * inner[1].sign < 0.0:
        return False
    return sign_is_certain(segment.engine, segment.a) and sign_is_certain(segment.engine, last)


# ------------------------------------------------------------------ the determinant
@lru_cache(maxsize=64)
def _random_vector(n: int) -> np.ndarray:
    """Return a fixed random vector, shape (n,)."""
    return np.random.default_rng(7).standard_normal(n)


def singular(engine: Engine, point: Solved) -> bool:
    """Whether [[F_u, F_p], [tangent]] is singular: nearer to a singular matrix than `Settings.resolution`, or than the noise of the equations."""
    engine.residual(point.u, point.p)
    side = np.append(engine.row_sizes * _random_vector(engine.n), 0.0)
    image = engine.apply_inverse(engine.weights * point.tangent, side)
    near = max(engine.settings.resolution, LOCATING.noisy * engine.noise)
    return not (np.isfinite(image).all() and engine.norm(image) < 1.0 / near)


def is_jump(segment: Segment, root: Root) -> bool:
    """Whether a change of the determinant's sign is no branch point: the segment has jumped from one branch to another."""
    engine = segment.engine
    return not (engine.many or segment.length <= engine.settings.resolution or singular(engine, root.point))


def no_other_branch(engine: Engine, point: Solved) -> bool:
    """Whether no other branch passes a point with a multiplier +1: the parameter is stationary, but [[F_u, F_p], [tangent]] is regular.

    At a branch point this matrix has a null vector besides the tangent.
    """
    stationary = abs(point.tangent[-1]) <= engine.settings.stationary * engine.parameter_unit(point.p)
    return stationary and not singular(engine, point)


def turned(a: Solved, b: Solved) -> bool | None:
    """Whether det(F_u) has opposite signs at a and b; None if it is zero at one of them, or its sign is unknown."""
    product = a.sign * a.tangent[-1] * b.sign * b.tangent[-1]
    return bool(product < 0.0) if product else None


def sign_changes(segment: Segment, position: float, reach: float | None = None) -> bool:
    """Whether det(F_u) changes its sign within `reach` of a position on a segment, as it does if one eigenvalue vanishes there."""
    reach = segment.engine.settings.aside if reach is None else reach
    sides = segment.several((position - reach, position + reach))
    return sides[0] is not None and sides[1] is not None and turned(sides[0], sides[1]) is not False


def sign_is_certain(engine: Engine, point: Solved) -> bool:
    """Whether the sign of det [[F_u, F_p], [tangent]] at a point is certain despite the errors of F_u and F_p.

    Returns True for problems that do not estimate these errors (see :class:`contvines.problems.abilities.Doubtful`), or have sparse matrices.
    """
    problem = engine.problem
    if not isinstance(problem, Doubtful):
        return True
    from ..problems.dense import DenseWork

    engine.residual(point.u, point.p)
    work, doubts = engine.work, problem.doubts(engine.work, ROUNDING)
    if not isinstance(work, DenseWork) or not isinstance(doubts, np.ndarray):
        return True
    matrix = np.empty((engine.n + 1, engine.n + 1))
    matrix[:-1, :-1], matrix[:-1, -1] = work.jacobian, work.derivative
    matrix[-1] = engine.weights * point.tangent
    with np.errstate(all="ignore"):
        try:
            effect = np.abs(np.linalg.inv(matrix))[:, :-1] @ doubts
            return bool(np.abs(np.linalg.eigvals(effect)).max() < 1.0)
        except np.linalg.LinAlgError:
            return False


def surely_changes(segment: Segment, position: float) -> bool:
    """Whether a change of the determinant's sign at a position in [0, 1] of a segment is not rounding: the sign is certain on both sides."""
    ends = ((segment.a, 0.0), (segment.b, 1.0))
    return all(
        abs(position - s) <= segment.engine.settings.aside or sign_is_certain(segment.engine, end)
        for end, s in ends
    )
