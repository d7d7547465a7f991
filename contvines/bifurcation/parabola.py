"""The parabola through three neighbouring points: does what is positive at all of them pass zero between?"""

from __future__ import annotations

import numpy as np


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
