"""Errors of special points: by how much rounding of the equations and of the Jacobian, and the mesh of a solution, move their parameter value.

The error of the mesh comes from a solution on a mesh with intervals half as long. Both meshes have a solution on the plane across the branch at the
point (beside it, if the equations are singular). With s along the branch, its parameter p and a function g that vanishes at the special point,

    p* on the finer mesh - p* = (p_finer - p) - (dp/ds) (g_finer - g) / (dg/ds),

the first order of Newton's method. Gauss collocation of degree m leaves 4^-m of the error there (Ascher, Mattheij and Russell 1995, section 5.4).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine, Solved
from ..problems.abilities import Adaptive, Blurred, Doubtful, Linearised
from ..problems.protocol import BorderPoint, array_of
from ..shared.numbers import EPSILON
from .locate import Located, Segment
from .settings import LOCATING

ENTRY = 4.0 * EPSILON  # relative error of an entry: several roundings of half a unit in the last place each
SAMPLES = 4  # number of random vectors of errors
#: kind -> value of its critical multiplier (for a pair: its modulus)
CRITICAL = {"period-doubling": -1.0, "neimark-sacker": 1.0, "branch-point": 1.0, "symmetry-breaking": 1.0}
SINGULAR = ("branch-point", "symmetry-breaking")


def with_rounding_error(segment: Segment, event: Located, test: Callable[[Solved], float]) -> Located:
    """Return the event with its error enlarged to the rounding of its critical eigenvalue.

    Parameters
    ----------
    segment : Segment
    event : Located
    test : callable
        Test function of this eigenvalue, in units of the raw spectrum.
    """
    engine, a, b = segment.engine, segment.a, segment.b
    if engine.detection != "flow" or not isinstance(engine.problem, Blurred):
        return event
    engine.residual(event.point.u, event.point.p)
    change = abs(test(b) - test(a))
    if not change > 0.0:
        return event
    error = engine.problem.blur(engine.work) * abs(b.p - a.p) / change
    return replace(event, error=max(event.error, error)) if math.isfinite(error) else event


def rounding_of_parameter(engine: Engine, point: Solved) -> float:
    """Return by how much rounding of the equations moves the parameter of a solution, in the parameter's own unit.

    The inverse of [[F_u, F_p], [tangent]] maps errors of F to errors of (u, p). The result is three standard deviations, estimated from a few vectors
    of errors with random signs. It grows like the inverse of the distance from a branch point.
    """
    border = engine.weights * point.tangent
    engine.residual(point.u, point.p)
    problem = engine.problem
    sizes = ENTRY * (problem.terms(point.u) if isinstance(problem, Adaptive) else engine.row_sizes)
    signs = np.sign(np.random.default_rng(5).standard_normal((SAMPLES, engine.n)))
    shifts = [float(engine.apply_inverse(border, engine.join(sizes * row, 0.0))[-1]) for row in signs]
    found = 3.0 * math.sqrt(sum(size * size for size in shifts) / SAMPLES)
    return found if math.isfinite(found) else 0.0


def singular_within(engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray) -> float:
    """Return by how much rounding and difference errors of (F_u, F_p) may move the parameter value of a branch point.

    With the null vectors of M = [[F_u, F_p], [tangent]], M x = 0 = y M, errors E of the entries change y M x by up to |y| E |x|; it
    grows along the branch with the slope y M' x (perturbation of a simple singular value: Stewart and Sun, Matrix Perturbation Theory
    (1990), theorem IV.2.3). Zero where it cannot be determined.
    """
    problem = engine.problem
    if not isinstance(problem, Doubtful):
        return 0.0
    engine.residual(u, p)
    doubts = problem.doubts(engine.work, ENTRY)
    if doubts is None:
        return 0.0
    right, left = _null_vectors(engine, u, p, tangent)
    with np.errstate(all="ignore"):
        error = float(np.abs(left) @ (doubts @ np.abs(right)))
        change = abs(_slope(engine, u, p, tangent, left, right))
        found = error * abs(float(tangent[-1])) / change if change > 0.0 else 0.0
    return found if math.isfinite(found) else 0.0


def missed(engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray) -> float:
    """Return an estimate of the error of a branch point's parameter value: one Newton step for conditions that hold there.

    The derivatives of y.F along both directions of the kernel, the tangent t and the null vector x of M (y as for `singular_within`),
    vanish at a branch point: y F'' [t, t] a + y F'' [t, x] c = -y F' t and the same with x. Zero where the step cannot be obtained.
    """
    if not isinstance(engine.problem, Doubtful):
        return 0.0
    engine.residual(u, p)
    if engine.problem.doubts(engine.work, ENTRY) is None:
        return 0.0
    right, left = _null_vectors(engine, u, p, tangent)
    directions = (tangent, right / (engine.norm(right) or math.nan))
    with np.errstate(all="ignore"):
        engine.residual(u, p)
        values = np.array([_image(engine, left, direction) for direction in directions])
        bent = np.array(
            [
                [_slope(engine, u, p, direction, left, other) for other in directions]
                for direction in directions
            ]
        )
        if not (np.isfinite(bent).all() and np.linalg.cond(bent) < LOCATING.bent):
            return 0.0
        step = np.linalg.solve(bent.T, -values)
    found = abs(float(step @ [direction[-1] for direction in directions]))
    return found if math.isfinite(found) else 0.0


def _image(engine: Engine, left: np.ndarray, direction: np.ndarray) -> float:
    """Return y (F_u, F_p) v for a direction v, at the point linearised last; `left` is y, `way` is v."""
    work = _linearised(engine)
    return float(left @ (work.jacobian @ direction[:-1] + work.derivative * direction[-1]))


def _linearised(engine: Engine) -> Linearised:
    """Return the workspace as that of a problem made of Python callables; only these estimate errors of their entries."""
    assert isinstance(engine.work, Linearised)
    return engine.work


def _slope(
    engine: Engine, u: np.ndarray, p: float, direction: np.ndarray, left: np.ndarray, vector: np.ndarray
) -> float:
    """Return the derivative of y (F_u, F_p) x along a direction of unit length in the metric; `left` is y, `vector` is x."""
    values = []
    offset = engine.settings.offset
    for side in (-offset, offset):
        engine.residual(u + side * direction[:-1], p + side * float(direction[-1]))
        values.append(_image(engine, left, vector))
    return (values[1] - values[0]) / (2.0 * offset)


def _null_vectors(
    engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the right and left null vectors of [[F_u, F_p], [tangent]], the left one without the last entry, both with largest entry one."""
    problem = engine.problem
    n, border = engine.n, engine.weights * tangent
    side = np.append(engine.row_sizes * np.random.default_rng(4).standard_normal(n), 0.0)
    right = engine.apply_inverse(border, side)
    other, left, unused = problem.workspace(), np.empty(n + 1), np.empty(n + 1)
    engine.residual(u, p)
    assert problem.kernels.transpose is not None
    problem.kernels.transpose(problem.data, engine.work, border[:-1], other)
    array_of(other)[:] = -side[:-1] / engine.row_sizes
    turned = np.append(_linearised(engine).derivative, border[-1])
    with np.errstate(all="ignore"):
        problem.kernels.bordered(problem.data, other, turned, 0.0, left, unused)
        return right / np.abs(right).max(), left[:-1] / np.abs(left[:-1]).max()


# ------------------------------------------------------------------ the mesh
@runtime_checkable
class Started(Adaptive, Protocol):
    """A problem on a mesh whose `refined` starts from the unknowns `u0`."""

    u0: np.ndarray


class Special(BorderPoint, Protocol):
    """Protocol of a special point of a branch."""

    @property
    def kind(self) -> str: ...
    @property
    def multipliers(self) -> NDArray[np.complex128]: ...


def mesh_error(engine: Engine, special: Special) -> float | None:
    """Return the error of the parameter at a special point, from a finer mesh; None if it cannot be computed.

    Parameters
    ----------
    engine : Engine
        Engine of a problem on a mesh.
    special : SpecialPoint
    """
    problem, settings = engine.problem, engine.settings
    if not isinstance(problem, Started):
        return None
    u, p, tangent = special.u, float(special.value), engine.unit(special.tangent)
    singular = special.kind in SINGULAR
    at_point = None if singular else engine.across(u, p, tangent)
    nearby = engine.across(*_moved(u, p, tangent, settings.offset), tangent)
    coarse = nearby if singular else at_point
    if coarse is None or nearby is None:
        return None
    problem.u0 = coarse.u
    finer = Engine(problem.refined(), engine.within, settings)
    direction = np.append(problem.halved(tangent[:-1], True), tangent[-1])
    fine = finer.across(problem.halved(coarse.u), coarse.p, direction)
    if fine is None:
        return None
    first = 0.0 if at_point is None else _vanishing(engine, special, at_point.row)
    second = _vanishing(engine, special, nearby.row)
    missed = _vanishing(finer, special, fine.row) - (second if singular else first)
    found, along = abs(fine.p - coarse.p), abs(coarse.tangent[-1] / engine.inner(tangent, coarse.tangent))
    if missed:
        found += along * abs(missed) * settings.offset / abs(second - first) if second != first else math.inf
    return settings.mesh_caution * found if math.isfinite(found) else None


def _moved(u: np.ndarray, p: float, tangent: np.ndarray, length: float) -> tuple[np.ndarray, float]:
    """Return the point (u, p) moved along the tangent by a length in the metric."""
    return u + length * tangent[:-1], p + length * float(tangent[-1])


def _vanishing(engine: Engine, special: Special, row: np.ndarray) -> float:
    """Return the function that vanishes at a special point (margin or critical multiplier), from a row near it; 0 for other kinds."""
    if special.margin_index is not None:
        return float(row[2 * engine.m + special.margin_index])
    if special.kind not in CRITICAL:
        return 0.0
    spectrum = engine.spectrum(row)
    if special.kind == "neimark-sacker":
        pairs = special.multipliers[special.multipliers.imag > 0.0]
        pair = pairs[int(np.argmin(np.abs(np.abs(pairs) - 1.0)))]
        return float(np.abs(spectrum[int(np.argmin(np.abs(spectrum - pair)))])) - 1.0
    place = CRITICAL[special.kind]
    return float(spectrum[int(np.argmin(np.abs(spectrum - place)))].real) - place
