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
