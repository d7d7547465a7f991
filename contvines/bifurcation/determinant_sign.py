"""Is the sign of a determinant beyond rounding?

A matrix is regular, and its determinant has one sign, for all errors of its entries up to E where the spectral radius of |M^-1| E is
below one (Rump, Linear Multilinear Algebra 47 (2000) 1, theorem 1.1; with E a multiple of |M| the radius is the componentwise condition
number of Bauer and Skeel, which scales of rows and columns do not change). Elsewhere the sign may be that of rounding, and says nothing.
"""

from __future__ import annotations

import numpy as np

from ..continuation.engine import Engine, Solved
from ..problems.abilities import Doubtful
from .segment import Segment

ROUNDING = 64 * 2.0**-53  # of entries


def certain(engine: Engine, point: Solved) -> bool:
    """Whether the sign of det [[F_u, F_p], [tangent]] at a point is known in spite of the errors of F_u and F_p.

    True also of problems that do not tell those errors (:class:`contvines.problems.abilities.Doubtful`), or whose matrices are sparse.
    """
    problem = engine.problem
    if not isinstance(problem, Doubtful):
        return True
    engine.residual(point.u, point.p)
    doubts = problem.doubts(engine.work, ROUNDING)
    if not isinstance(doubts, np.ndarray):
        return True
    matrix = np.empty((engine.n + 1, engine.n + 1))
    matrix[:-1, :-1], matrix[:-1, -1] = engine.work.jacobian, engine.work.derivative
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
