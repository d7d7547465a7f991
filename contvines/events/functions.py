"""Test functions: numbers that change sign at a special point.

Multipliers are taken one by one: ``("plus", k)`` is the logarithm of the k-th largest real multiplier, so two multipliers
that cross at once are two events. A product of test functions would not change sign.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine, Solved

PAST = 1e-10  # multipliers of a conservative system lie on the circle up to roundoff: that is no crossing
LIMIT = 1.0  # test functions of multipliers are clipped here; only the neighbourhood of zero matters


def counts(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """How many multipliers are past the circle: real > 1, real < -1, complex pairs outside; shape (n, 3).

    For flows: real eigenvalues > 0, nothing, complex pairs with positive real part; where only branch points are looked
    for ("real"), the first of these.
    """
    result = np.zeros((len(spectrum), 3), dtype=np.int64)
    real = spectrum.imag == 0.0
    upper = spectrum.imag > 0.0
    if kind == "map":
        columns = (
            real & (spectrum.real > 1.0 + PAST),
            real & (spectrum.real < -1.0 - PAST),
            upper & (np.abs(spectrum) > 1.0 + PAST),
        )
    elif kind == "real":
        columns = (real & (spectrum.real > PAST),)
    elif kind == "flow":
        columns = (real & (spectrum.real > PAST), np.zeros_like(real), upper & (spectrum.real > PAST))
    else:
        return result
    for place, past in enumerate(columns):
        for j in range(past.shape[1]):  # few columns, many rows
            result[:, place] += past[:, j]
    return result


def crossing(spectrum: NDArray[np.complex128], kind: str, name: str, k: int) -> float:
    """The test function of the k-th multiplier of a sort at one point: positive past the circle."""
    if name == "pair":
        part = spectrum[spectrum.imag > 0.0]
        values = np.sort(np.abs(part) if kind == "map" else part.real)[::-1]
    else:
        values = np.sort(spectrum[spectrum.imag == 0.0].real * (-1.0 if name == "minus" else 1.0))[::-1]
    if len(values) < k:
        if name == "pair" or len(values) == len(spectrum):
            return -LIMIT
        # a complex pair may meet on the real axis: continuous only where that happens at the critical place itself,
        # as it does in conservative systems
        place = 0.0 if kind != "map" else (-1.0 if name == "minus" else 1.0)
        return -min(float(np.abs(spectrum[spectrum.imag != 0.0] - place).min()), LIMIT)
    value = float(values[k - 1])
    if kind == "map":
        value = float(np.log(value)) if value > 0.0 else -LIMIT
    return min(max(value, -LIMIT), LIMIT)


def balance(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """Smallest number past the circle plus the largest before it, of the real multipliers of each row; NaN without both.

    Where one multiplier leaves while another enters at the same place, as at branch points with the symmetry of a triangle, no
    count changes, but this sum passes through zero.
    """
    real = np.where(spectrum.imag == 0.0, spectrum.real, np.nan)
    if kind == "map":
        with np.errstate(all="ignore"):
            real = np.where(real > 0.0, np.log(real), np.nan)
    past = np.where(real > 0.0, real, np.inf).min(axis=-1, initial=np.inf)
    before = np.where(real <= 0.0, real, -np.inf).max(axis=-1, initial=-np.inf)
    both = np.isfinite(past) & np.isfinite(before)
    return np.where(both, np.where(both, past, 0.0) + np.where(both, before, 0.0), np.nan)


def nearest_to_circle(spectrum: NDArray[np.complex128], kind: str) -> np.ndarray:
    """Distance from the circle (the axis) of the nearest real positive multiplier of each row, as a logarithm; clipped at LIMIT."""
    real = np.where(spectrum.imag == 0.0, spectrum.real, np.nan)
    if kind == "map":
        with np.errstate(all="ignore"):
            real = np.where(real > 0.0, np.log(real), np.nan)
    return np.nan_to_num(np.fmin.reduce(np.abs(real), axis=-1, initial=LIMIT), nan=LIMIT)


class SymmetryTest:
    """The part of u that a symmetry changes: u - T(u), modulo the shift by a period, in units of the unknowns' scale.

    T is usually a signed permutation plus a constant; it is then found out once and applied to whole chunks.
    """

    def __init__(
        self, symmetry: Any, n: int, period_shift: np.ndarray | None, scale: np.ndarray | None = None
    ) -> None:
        self.scale = None if scale is None or (scale == 1.0).all() else scale
        self.symmetry, self.kind = symmetry, symmetry.kind
        self.shift = (
            None if period_shift is None or not np.any(period_shift) else np.asarray(period_shift, float)
        )
        # numbers without a pattern: multiples of irrational numbers
        probe, check = (0.1 + 0.8 * np.modf(np.sqrt(a) * np.arange(1.0, n + 1.0))[0] for a in (2.0, 3.0))
        self.affine: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        try:
            constant = np.asarray(symmetry.apply(np.zeros(n)), dtype=float)
            image = np.asarray(symmetry.apply(probe), dtype=float) - constant
            order = np.empty(n, dtype=int)
            order[np.argsort(np.abs(image), kind="stable")] = np.argsort(probe, kind="stable")
            signs = np.sign(image)
            wrong = np.abs(signs * check[order] + constant - symmetry.apply(check)).max()
            if np.abs(signs * probe[order] - image).max() < 1e-9 and wrong < 1e-9:
                self.affine = (order, signs, constant)
        except (ArithmeticError, ValueError, IndexError):
            self.affine = None

    def part(self, points: np.ndarray) -> np.ndarray:
        """u - T(u) for points of shape (n, N)."""
        if self.affine is not None:
            order, signs, constant = self.affine
            gap = points - (signs * points[:, order] + constant)
        else:
            gap = points - np.array([self.symmetry.apply(u) for u in points])
        if self.shift is not None:
            turns = np.round(gap @ self.shift / (self.shift @ self.shift))
            gap = gap - turns[:, None] * self.shift
        return gap if self.scale is None else gap / self.scale

    def image_direction(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative of T at u applied to v."""
        if self.affine is not None:
            order, signs, _ = self.affine
            return signs * v[order]
        scale = 1e-5 / max(float(np.abs(v).max()), 1e-300)
        return (self.symmetry.apply(u + scale * v) - self.symmetry.apply(u - scale * v)) / (2.0 * scale)


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
            self.row = x2 / max(float(np.abs(x2).max()), 1e-300)
        value = float(self.row @ x)
        return 1.0 / value if value != 0.0 else np.nan
