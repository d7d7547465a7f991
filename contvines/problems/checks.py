"""Checks of a user's equations: given derivatives against differences, empty rows, kinks and jumps."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .derivatives import Differentiated
from .differences import along
from .functions import NotEvaluable, Operator, Sparse, as_matrix
from .scales import Scales
from .settings import DERIVATIVES

if TYPE_CHECKING:
    from scipy.sparse import csc_array


def disagreement(
    functions: Differentiated, u: np.ndarray, p: float, scales: Scales | None = None
) -> str | None:
    """Compare given derivatives with differences of f at a point: a sentence with the wrong entry, or None if they agree.

    The derivative along one random direction is compared; single entries only if it disagrees. With `scales`, differences below
    the rounding errors in the units of unknowns, parameter and rows are ignored.

    Raises
    ------
    NotEvaluable
        If a given derivative cannot be evaluated.
    """
    with np.errstate(all="ignore"):
        return _wrong_jacobian(functions, u, p, scales) or _wrong_derivative(functions, u, p, scales)


def empty_row(functions: Differentiated, u: np.ndarray, p: float) -> str | None:
    """Return a sentence if an entry of f is zero at the start and at all points around it, so that it is no equation; else None."""
    draw = np.random.default_rng(8)
    zero, name = functions.value(u, p) == 0.0, functions.parameters.varying
    for reach in (10.0**k for k in range(-3, 3)):  # far away, too: an equation may be flat near the start
        step, shift = (
            reach * functions.lengths * draw.uniform(-1.0, 1.0, len(u)),
            reach * draw.uniform(-1.0, 1.0),
        )
        for side in (1.0, -1.0):
            if not zero.any():
                return None
            try:
                zero = zero & (functions.value(u + side * step, p + side * shift) == 0.0)
            except NotEvaluable:
                return None
    if not zero.any():
        return None
    i = int(np.argmax(zero))
    return (
        f"row {i} of {functions.name} is zero at the start and at all points tried around it, for any unknowns and {name}: "
        f"it is no equation, and {len(u)} equations are needed for {len(u)} unknowns"
    )


def _wrong_derivative(
    functions: Differentiated, u: np.ndarray, p: float, scales: Scales | None
) -> str | None:
    if functions.given_slope is None:
        return None
    n, name = len(u), functions.parameters.varying
    raw = functions.given_slope.raw(u, p)
    matrix = isinstance(raw, np.ndarray | Sparse | Operator) and n > 1 and raw.shape == (n, n)
    given = np.zeros(0) if matrix else functions.given_slope.flat(raw, u, p)
    shape = (n, n) if matrix else given.shape
    if shape != (n,):
        hint = (
            f"; the Jacobian by the unknowns is given as jacobian=, the derivative by {name} as derivative="
        )
        return f"derivative returns shape {shape}; ({n},) is needed{hint if prod(shape) == n * n else ''}"
    line = functions.quietly(lambda t: functions.value(u, p + t))
    near = along(line, functions.parameter_length(u, p), functions.noise)
    gap = (
        np.abs(given - near.value)
        - DERIVATIVES.agree * np.maximum(np.abs(given), np.abs(near.value))
        - 10.0 * near.error
    )
    gap -= DERIVATIVES.faint * np.abs(near.value).max()
    if scales is not None:
        gap -= DERIVATIVES.rounded * scales.rows / scales.parameter
    if not np.isfinite(near.value).all() or not (gap > 0.0).any():
        return None
    i = int(np.argmax(gap))
    return (
        f"derivative disagrees with {functions.name} in row {i}: it returns {given[i]:.10g}, "
        f"differences of {functions.name} give {near.value[i]:.10g}, at {functions.parameters.varying} = {p:.10g}"
    )


def _wrong_jacobian(functions: Differentiated, u: np.ndarray, p: float, scales: Scales | None) -> str | None:
    n = len(u)
    if functions.given_matrix is not None:
        matrix = as_matrix(functions.given_matrix.raw(u, p), n)
    elif functions.sparsity is not None:
        matrix = functions.jacobian(u, p)
    else:
        return None
    direction = functions.lengths * np.random.default_rng(4).uniform(0.5, 1.0, n) * (-1.0) ** np.arange(n)
    near = along(functions.quietly(lambda t: functions.value(u + t * direction, p)), 0.3, functions.noise)
    if not np.isfinite(near.value).all():
        return None
    product = matrix @ direction
    rows = np.abs(near.value)
    if not isinstance(matrix, Operator):
        rows = np.maximum(rows, np.asarray(abs(matrix) @ np.abs(direction)).reshape(-1))
    gap = np.abs(product - near.value) - DERIVATIVES.agree * rows - 10.0 * near.error
    if scales is not None:
        gap -= DERIVATIVES.rounded * scales.rows * float(np.abs(direction / scales.unknowns).max())
    if np.isfinite(product).all() and not (gap > DERIVATIVES.faint * rows.max()).any():
        return None
    i = int(np.argmax(np.where(np.isfinite(gap), gap, np.inf)))
    place = f"at {functions.parameters.varying} = {p:.10g}"
    if functions.given_matrix is None:
        return f"sparsity lacks an entry of {functions.name} in row {i}, {place}"
    entry = _wrong_entry(functions, matrix, u, p, i)
    if entry is None:
        return f"jacobian disagrees with differences of {functions.name} in row {i}, {place}"
    j, given, found = entry
    turned = ""
    if (
        isinstance(matrix, np.ndarray)
        and (np.abs(matrix.T @ direction - near.value) <= DERIVATIVES.agree * rows + 10.0 * near.error).all()
    ):
        turned = "; it seems to be transposed"
    return (
        f"jacobian disagrees with {functions.name} in row {i}, column {j}: it returns {given:.10g}, "
        f"differences of {functions.name} give {found:.10g}, {place}{turned}"
    )


def _wrong_entry(
    functions: Differentiated, matrix: np.ndarray | csc_array | Operator, u: np.ndarray, p: float, i: int
) -> tuple[int, float, float] | None:
    """The entry of row i with the largest error: its column, the given number and the number by differences."""
    n = len(u)
    if isinstance(matrix, Operator):
        return None
    row = matrix[i] if isinstance(matrix, np.ndarray) else matrix[[i]].toarray()[0]
    columns = range(n) if n <= 400 else [int(j) for j in np.flatnonzero(row)]
    worst, result = 0.0, None
    for j in columns:
        found = float(functions.column(u, p, j).value[i])
        gap = abs(found - row[j]) * functions.lengths[j]
        if not gap <= worst:
            worst, result = gap, (j, float(row[j]), found)
    return result


POINTS = 24  # intervals of the line in each round
ROUNDS = 7  # each round samples the four intervals around the largest second difference
NOISY = 20.0  # second differences below this multiple of the noise are not used


class Break(NamedTuple):
    """A point ``at`` of a line where a function is not smooth: ``kind`` is "kink" or "jump", ``row`` the entry with the largest one."""

    kind: str
    at: float
    row: int


def find_break(
    f: Callable[[float], np.ndarray], length: float, rows: np.ndarray, noise: float | np.ndarray = 0.0
) -> Break | None:
    """Find the sharpest kink or jump of f between -length and length; None if there is none.

    The function is sampled, then sampled again, more finely, around the largest second difference. On the shrinking interval the slopes
    on both sides of a kink, or the values on both sides of a jump, keep their difference, while a smooth function becomes straight.

    Parameters
    ----------
    f : callable
        t -> ndarray of shape (n,); not finite where it cannot be evaluated.
    length : float
    rows : ndarray, shape (n,)
        Typical change of each entry when t changes by 1.
    noise : float or ndarray
        Standard deviation of f; smaller breaks are not reported.
    """
    low, high, t, values, k, step = -length, length, np.zeros(0), rows, 0, 0.0
    for _ in range(ROUNDS):
        t = np.linspace(low, high, POINTS + 1)
        values = np.array([f(x) for x in t]) / rows
        if not np.isfinite(values).all():
            return None
        second = np.abs(np.diff(values, 2, axis=0)).max(axis=1)
        if second.max() < NOISY * float(np.max(noise / rows)):
            return None
        k = int(np.argmax(second)) + 1
        step = float(t[1] - t[0])
        low, high = t[max(k - 2, 0)], t[min(k + 2, POINTS)]
    if step < DERIVATIVES.roundoff * max(abs(low), abs(high)):
        return None
    left, right = values[max(k - 3, 0)], values[min(k + 3, POINTS)]
    if k < 4 or k > POINTS - 4:
        return None
    before = (values[k - 2] - left) / (t[k - 2] - t[max(k - 3, 0)])
    after = (right - values[k + 2]) / (t[min(k + 3, POINTS)] - t[k + 2])
    leap = np.abs(values[k + 2] - values[k - 2]) - 4.0 * step * np.maximum(np.abs(before), np.abs(after))
    row = int(np.argmax(leap))
    if leap[row] > DERIVATIVES.leap:
        return Break("jump", float(t[k]), row)
    bend = np.abs(after - before)
    row = int(np.argmax(bend))
    return Break("kink", float(t[k]), row) if bend[row] > DERIVATIVES.kink else None
