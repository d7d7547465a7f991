"""Fixed points of a simulated return map, stable or not, from starts far away."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from orbits.settings import SIMULATING, SOLVING

ITERATIONS = 12
LONGEST = 0.2  # of the box: longer steps are shortened
SHORTER = 3  # times a step is halved where the motion does not come back
BEYOND = 0.5  # of the box: so far outside nothing is looked for


def fixed_point(
    step: Callable[[np.ndarray], np.ndarray], x: np.ndarray, box: np.ndarray, hard: np.ndarray
) -> np.ndarray | None:
    """A point with ``step(x) = x``, by Newton's method with differences; None if none is reached.

    Parameters
    ----------
    step : callable
        The map; NaN where there is no image.
    x : float array (d,)
        Where to begin.
    box : float array (d, 2)
        Smallest and largest value of each coordinate of the starts.
    hard : bool array (d,)
        Which limits of the box cannot be passed (walls).
    """
    low, high = box.T
    size = high - low
    middle, outside = 0.5 * (low + high), (0.5 + BEYOND) * size
    shift = SIMULATING.nudge * size
    one = np.eye(len(size))
    matrix = np.empty_like(one)
    x = np.array(x, dtype=float)
    image = step(x)
    for _ in range(ITERATIONS):
        rest = x - image
        far = float(np.abs(rest / size).max())
        if far < SOLVING.scaled:
            return x
        if not far < np.inf:
            return None
        for j, moved in enumerate(np.where(x > middle, -shift, shift)):  # into the box
            there = x.copy()
            there[j] += moved
            matrix[:, j] = (step(there) - image) / moved
        change = _solved(matrix - one, rest)
        length = float(np.abs(change / size).max())
        if not length < np.inf:
            return None
        change *= min(1.0, LONGEST / max(length, LONGEST))
        there = x
        for _ in range(SHORTER):
            there = x + change
            if hard.any():
                there = np.where(hard, np.clip(there, low, high), there)
            image = step(there)
            if not np.isnan(image[0]):
                break
            change *= 0.5
        x = there
        if (np.abs(x - middle) > outside).any():
            return None
    return None


def _solved(matrix: np.ndarray, rest: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(matrix, rest)
    except np.linalg.LinAlgError:
        return np.full(len(rest), np.nan)
