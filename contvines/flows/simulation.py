"""Simulation of flows by scipy's integrators: checks cycles, and finds attractors."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from ..problems.functions import NotEvaluable

if TYPE_CHECKING:
    from collections.abc import Callable

    from .field import Field


def rates(field: Field, p: float) -> Callable[[float, np.ndarray], np.ndarray]:
    """(t, x) -> x' for scipy."""

    f, parameters, forced = field.f, field.values.at(p), field.forced

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        try:
            value = np.asarray(f(x, parameters, t) if forced else f(x, parameters)).reshape(len(x))
            if value.dtype.kind == "c":
                value = np.where(np.imag(value) == 0.0, np.real(value), np.nan)
            return value.astype(float)
        except Exception:  # a user's function may fail in any way
            return np.full(len(x), np.nan)

    return rate


def integrated(field: Field, p: float, x: np.ndarray, start: float, stop: float) -> np.ndarray:
    """The state at another time; NaN where the integrator fails."""
    from scipy.integrate import solve_ivp

    s = field.settings
    size = cast("float", s.exact_absolute * (s.smallest * field.lengths + np.abs(x)))
    found = solve_ivp(rates(field, p), (start, stop), x, method="DOP853", rtol=s.exact_relative, atol=size)
    return found.y[:, -1] if found.success else np.full(len(x), np.nan)


def variational(
    field: Field, p: float, x: np.ndarray, start: float, stop: float
) -> tuple[np.ndarray, np.ndarray]:
    """The state at another time and its derivative by the first one; NaN where the integrator fails."""
    from scipy.integrate import solve_ivp

    d = len(x)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        time, state = np.array([t]) if field.forced else None, y[None, :d]
        matrix = field.jacobian(state, p, time)[0]
        return np.concatenate([field(state, p, time)[0], (matrix @ y[d:].reshape(d, d)).reshape(-1)])

    begin = np.concatenate([x, np.eye(d).reshape(-1)])
    s = field.settings
    try:
        found = solve_ivp(
            rate, (start, stop), begin, method="DOP853", rtol=s.exact_relative, atol=s.exact_absolute
        )
    except NotEvaluable:
        return np.full(d, np.nan), np.full((d, d), np.nan)
    end = found.y[:, -1] if found.success else np.full(len(begin), np.nan)
    return end[:d], end[d:].reshape(d, d)
