"""Locating a special point on a segment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from ..continuation.engine import Solved
from ..continuation.layout import Aim
from ..shared.floating_point import EPSILON, ROUNDED
from .segment import Segment
from .settings import LOCATING

NODES = 8
NARROWER, WIDER = (
    0.5 ** np.arange(7),
    2.0 ** np.arange(1, 6),
)  # windows that are tried, in units of the first one


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
        False: the test function jumps over zero.
    """

    position: float
    point: Solved
    error: float
    continuous: bool = True


def locate(
    segment: Segment,
    test: Callable[[Solved], float] | Aim,
    tolerance: float = LOCATING.bracket,
    fallback_zero: bool = False,
    jump: float = np.inf,
) -> Root | None:
    """The zero of a test function whose bordered system is regular there.

    Parameters
    ----------
    segment : Segment
    test : Aim or callable
        Of opposite signs at the two ends; a callable is Solved -> float.
    tolerance : float
        Width of the final bracket relative to the segment.
    fallback_zero : bool
        Of an aim: where the ends do not have opposite signs after all, take the end at which it is smallest.
    jump : float
        A test that changes by more than this over a tiny part of the segment jumps; the root is then not continuous.

    Returns
    -------
    Root or None
        None if the ends do not bracket a zero or the segment cannot be solved.
    """
    if isinstance(test, Aim):
        aim = replace(test, anyway=1) if fallback_zero else test
        hit = segment.search(aim, tolerance, jump)
        if hit is None:
            return None
        if hit.point is not None:
            return Root(hit.place, hit.point, hit.error, hit.jump <= LOCATING.jump)
        # a place that was solved for once and is not found again, as where equations are singular: every point is kept below
    solved: dict[float, Solved] = {}

    def value(s: float) -> float:
        point = segment.at(s)
        if point is None:
            return float("nan")
        solved[s] = point
        return float(test(point))

    from .roots import bracketed_root

    fa, fb = value(0.0), value(1.0)
    if not (np.isfinite(fa) and np.isfinite(fb)):
        return None
    if fa * fb > 0.0:
        return None
    s, low, high, flow, fhigh = bracketed_root(value, 0.0, 1.0, fa, fb, tolerance, jump)
    width = abs(solved[high].p - solved[low].p) + 2.0 * EPSILON * abs(solved[s].p)
    return Root(
        s, solved[s], max(width, solved[s].correction * LOCATING.halved), abs(fhigh - flow) <= LOCATING.jump
    )


def locate_singular(
    segment: Segment, test: Callable[[Solved], float], rough: float, width: float = 0.2
) -> Root | None:
    """The zero of a test function at a branch point, where the bordered system is singular.

    Newton's method loses digits near such a point, so the branch is solved at Chebyshev nodes beside it, and the point and
    the test function are interpolated. The interpolation converges like (width/2)^8. Narrower windows are tried, too, and on a segment that is so
    short that the point would be known to fewer digits than are asked for, wider ones, which reach out to both sides.

    Parameters
    ----------
    segment, test
        As for :func:`locate`.
    rough : float
        Approximate position.
    width : float
        Half of the first window, relative to the segment.
    """
    engine = segment.engine
    roots = _in_windows(segment, test, rough, width * NARROWER)
    if not roots:
        return None
    best = min(roots, key=itemgetter(0))[1]
    if best.error > engine.settings.located * engine.parameter_unit(best.point.p):
        # the segment is so short that rounding rules all over it, and less so on either side
        roots += _in_windows(segment, test, best.position, width * WIDER)
    roots.sort(key=itemgetter(0))
    best = roots[0][1]
    if len(roots) > 1 and engine.problem.scales is not None:
        # rounding rules in all windows, and the smallest of their estimates is small by chance
        apart = abs(roots[1][1].point.p - best.point.p)
        return best._replace(error=2.0 * max(best.error, roots[1][1].error, apart))
    return best


def _in_windows(
    segment: Segment, test: Callable[[Solved], float], rough: float, widths: np.ndarray
) -> list[tuple[float, Root]]:
    """Roots with what they are wrong by, from windows of such widths, until rounding makes them worse."""
    roots: list[tuple[float, Root]] = []
    for width in widths.tolist():
        found = _interpolated(segment, test, rough, width)
        if found is None:
            continue
        root, residual = found
        roots.append((max(root.error, residual / segment.engine.size(root.point.u)), root))
        score, best = roots[-1][0], min(score for score, _ in roots)
        if score > best or score < ROUNDED:
            break
        rough = root.position
    return roots


def _interpolated(
    segment: Segment, test: Callable[[Solved], float], rough: float, width: float
) -> tuple[Root, float] | None:
    from .roots import bracketed_root, chebyshev_fit, chebyshev_nodes, chebyshev_value

    engine = segment.engine
    nodes = chebyshev_nodes(NODES)
    points, values = [], []
    # nearest to the singular point first: a test may choose its reference there
    nodes = np.array(sorted(nodes, key=abs))
    for x, point in zip(nodes.tolist(), segment.several(rough + width * nodes)):
        if point is None:
            return None
        points.append((x, point))
        values.append((x, float(test(point))))
    points.sort(key=lambda pair: -pair[0])
    values.sort(key=lambda pair: -pair[0])
    f = np.array([value for _, value in values])
    if not np.all(np.isfinite(f)):
        return None
    series = chebyshev_fit(f)
    grid = np.linspace(-1.2, 1.2, 49)
    on_grid = chebyshev_value(series, grid)
    changes = np.flatnonzero(on_grid[:-1] * on_grid[1:] <= 0.0)
    if not len(changes):
        return None
    i = int(changes[np.argmin(np.abs(grid[changes] + 0.025))])
    x = bracketed_root(
        lambda t: float(chebyshev_value(series, t)), grid[i], grid[i + 1], on_grid[i], on_grid[i + 1]
    )[0]
    z = chebyshev_fit(np.array([engine.join(p.u, p.p) for _, p in points]))
    tangent = chebyshev_fit(np.array([p.tangent for _, p in points]))
    rows = np.array([p.row for _, p in points])
    known = np.isfinite(rows).all(axis=0)
    here = chebyshev_value(z, x)
    u, p = np.ascontiguousarray(here[:-1]), float(here[-1])
    residual = engine.residual(u, p)
    row = np.where(known, chebyshev_value(chebyshev_fit(np.where(known, rows, 0.0)), x), np.inf)
    polished = engine.polish(u, p, segment.border, float(segment.border @ here), segment.direction)
    if polished is not None:
        row = polished.row
    slope = abs(float(chebyshev_value(np.polynomial.chebyshev.chebder(series), x)))
    error = float(np.abs(z[-1, -1]) + np.abs(z[-2, -1]))
    if slope > 0.0:
        shift = (np.abs(series[-1]) + np.abs(series[-2])) / slope
        error += float(
            shift * abs(np.polynomial.chebyshev.chebval(x, np.polynomial.chebyshev.chebder(z[:, -1])))
        )
    point = Solved(u, p, engine.unit(chebyshev_value(tangent, x)), row, 0.0, residual, error)
    return Root(rough + width * x, point, error), residual
