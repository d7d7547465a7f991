"""The bordered determinant det [[F_u, F_p], [tangent]]: is it zero, what is its sign, and a test function with a simple zero where it is.

det [[F_u, F_p], [t]] = det(F_u) t.t / t_p for the tangent t: with its sign, which comes with every point, that of det(F_u) is
known. It has the accuracy of an elimination with pivots; eigenvalues may have less, where the others are very much larger.

A matrix is regular, and its determinant has one sign, for all errors of its entries up to E where the spectral radius of |M^-1| E is
below one (Rump, Linear Multilinear Algebra 47 (2000) 1, theorem 1.1; with E a multiple of |M| the radius is the componentwise condition
number of Bauer and Skeel, which scales of rows and columns do not change). Elsewhere the sign may be that of rounding, and says nothing.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import NO_COLUMNS, SIGN, Aim
from ..problems.abilities import Doubtful
from ..shared.floating_point import EPSILON, TINY
from .locate import Root, locate, locate_singular
from .segment import Segment
from .settings import LOCATING

ROUNDING = 32.0 * EPSILON  # of entries
WIDTH = 0.02  # part of a segment, either side of a place that is known already
AT_SIGNS = Aim(SIGN, NO_COLUMNS)


class DeterminantTest:
    """A smooth function with a simple zero where [[F_u, F_p], [border]] is singular: 1 / (c . M^-1 b).

    b is a fixed vector, c the direction of M^-1 b near the zero.
    """

    def __init__(self, engine: Engine, border: np.ndarray) -> None:
        self.engine, self.border = engine, border
        self.side = np.random.default_rng(2).standard_normal(engine.n + 1)
        self.side[-1] = 0.0
        self.row: np.ndarray | None = None

    def __call__(self, point: Solved) -> float:
        engine = self.engine
        engine.residual(point.u, point.p)
        x = engine.apply_inverse(self.border, self.side)
        if self.row is None:
            x2 = engine.apply_inverse(self.border, np.append(x[:-1], 0.0))
            self.row = x2 / max(float(np.abs(x2).max()), TINY)
        value = float(self.row @ x)
        return 1.0 / value if value != 0.0 else np.nan


@lru_cache(maxsize=64)
def _side(n: int) -> np.ndarray:
    """A vector without a pattern."""
    return np.random.default_rng(7).standard_normal(n)


def singular(engine: Engine, point: Solved) -> bool:
    """Whether [[F_u, F_p], [tangent]] is singular: nearer to a singular matrix than segments are resolved, or the noise of the equations allows."""
    engine.residual(point.u, point.p)
    side = np.append(engine.row_sizes * _side(engine.n), 0.0)
    image = engine.apply_inverse(engine.weights * point.tangent, side)
    near = max(engine.settings.resolution, LOCATING.noisy * engine.noise)
    return not (np.isfinite(image).all() and engine.norm(image) < 1.0 / near)


def alone(engine: Engine, point: Solved) -> bool:
    """Whether the branch is alone at a point where a multiplier passes +1: the segment has led from one branch to another.

    Of a branch point the tangent leaves a null vector over; here [[F_u, F_p], [tangent]] is far from singular.
    """
    stationary = abs(point.tangent[-1]) <= engine.settings.stationary * engine.parameter_unit(point.p)
    return stationary and not singular(engine, point)


def turned(a: Solved, b: Solved) -> bool | None:
    """Whether det(F_u) has another sign at b than at a; None where it is zero at one of them, or has no sign."""
    product = a.sign * a.tangent[-1] * b.sign * b.tangent[-1]
    return bool(product < 0.0) if product else None


def passes(segment: Segment, position: float, reach: float | None = None) -> bool:
    """Whether det(F_u) changes its sign within a reach of a place on a segment, as it does where one eigenvalue vanishes."""
    reach = segment.engine.settings.aside if reach is None else reach
    sides = segment.several((position - reach, position + reach))
    return sides[0] is not None and sides[1] is not None and turned(sides[0], sides[1]) is not False


def certain(engine: Engine, point: Solved) -> bool:
    """Whether the sign of det [[F_u, F_p], [tangent]] at a point is known in spite of the errors of F_u and F_p.

    True also of problems that do not tell those errors (:class:`contvines.problems.abilities.Doubtful`), or whose matrices are sparse.
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


def passes_for_certain(segment: Segment, position: float) -> bool:
    """Whether a change of the sign within a segment, at a place in [0, 1], is none of rounding: it is known on both sides."""
    ends = ((segment.a, 0.0), (segment.b, 1.0))
    return all(
        abs(position - s) <= segment.engine.settings.aside or certain(segment.engine, end) for end, s in ends
    )


def by_sign(segment: Segment) -> Root | None:
    """Where the determinant changes its sign on a segment; None where the change may be that of rounding."""
    rough = locate(segment, AT_SIGNS, tolerance=segment.engine.settings.aside)
    if rough is None or not passes_for_certain(segment, rough.position):
        return None
    return locate_singular(segment, DeterminantTest(segment.engine, segment.border), rough.position) or rough


def by_elimination(segment: Segment, root: Root | None) -> Root | None:
    """The same root, or the one of 1/(c . M^-1 b) beside it if that is known better.

    Eigenvalues are rounded by the largest of them, which may be 1e9 times those that pass zero where the unknowns of the start are far
    larger than here.
    """
    settings, unit = (
        segment.engine.settings,
        1.0 if root is None else segment.engine.parameter_unit(root.point.p),
    )
    if root is None or not root.error > settings.rounding * unit:
        return root
    other = locate_singular(segment, DeterminantTest(segment.engine, segment.border), root.position, WIDTH)
    known = other is not None and other.error < root.error and abs(other.position - root.position) < WIDTH
    return other if known else root
