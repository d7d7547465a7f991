"""Is a point singular, as every branch point is?"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..continuation.engine import Engine, Solved

FAR = 1e7  # growth under the inverse of a bordered matrix that tells a singular one
NOISY = 1e-4  # ... and times the noise of the equations, which keeps matrices from being singular


@lru_cache(maxsize=64)
def _side(n: int) -> np.ndarray:
    """A vector without a pattern."""
    return np.random.default_rng(7).standard_normal(n)


def singular(engine: Engine, point: Solved) -> bool:
    """Whether [[F_u, F_p], [tangent]] is singular but for rounding, and the noise of the equations."""
    engine.residual(point.u, point.p)
    side = np.append(engine.row_sizes * _side(engine.n), 0.0)
    image = engine.apply_inverse(engine.weights * point.tangent, side)
    far = FAR if engine.noise <= 0.0 else min(FAR, NOISY / engine.noise)
    return not (np.isfinite(image).all() and engine.norm(image) < far)


def alone(engine: Engine, point: Solved) -> bool:
    """Whether the branch is alone at a point where a multiplier passes +1: the segment has led from one branch to another.

    Of a branch point the tangent leaves a null vector over; here [[F_u, F_p], [tangent]] is far from singular.
    """
    stationary = abs(point.tangent[-1]) <= engine.settings.stationary * engine.parameter_unit(point.p)
    return stationary and not singular(engine, point)
