"""Test functions of the user's own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..continuation.engine import Engine


def user_function(engine: Engine, function: Any) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A user function as (points, values) -> array.

    ``function`` is a callable (u, p) -> float, or a pair (name of a measure, value): zero where the measure has the value.
    """
    problem = engine.problem
    if callable(function):
        call: Callable[..., Any] = function
        return lambda points, values: np.array([float(call(u, float(p))) for u, p in zip(points, values)])
    try:
        pair: Any = function
        name, value = pair[0], float(pair[1])
    except (TypeError, ValueError, IndexError):
        raise ValueError(
            f"user function {function!r} must be a callable (u, p) -> float or a pair (measure, value)"
        ) from None
    if name == problem.parameter:
        return lambda points, values: values - value
    return lambda points, values: problem.measures((name,), points, values)[name] - value
