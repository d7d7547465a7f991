"""From a special point to the first points of the branches that leave it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .continuation.engine import Engine, Solved

SINGULAR = 1e-5  # a bordered system with a smaller singular direction (relative) counts as singular


@dataclass(frozen=True)
class Departure:
    """A branch that leaves a branch point.

    Attributes
    ----------
    problem : Problem
        Of the branch that leaves (the larger problem at a period doubling or symmetry breaking).
    origin : Solved
        The branch point itself; its tangent points along the new branch.
    ahead, back : Solved or None
        First points on either side, at distances ``amplitude`` and ``-amplitude`` along the null vector; ``back`` is
        None where it is an image of ``ahead``.
    direction : ndarray, shape (N + 1,)
        Null vector, of unit length in the metric.
    amplitude : float
    curvature : float
        p = p0 + curvature * amplitude^2 (from the even part, extrapolated to zero amplitude).
    slope : float
        p = p0 + slope * amplitude (zero where ``back`` is an image of ``ahead``).
    """

    problem: Any
    origin: Solved
    ahead: Solved
    back: Solved | None
    direction: np.ndarray
    amplitude: float
    curvature: float
    slope: float


def null_vectors(engine: Engine, u: np.ndarray, p: float, tangent: np.ndarray) -> list[np.ndarray]:
    """Null vectors of [[F_u, F_p], [tangent]] by inverse (subspace) iteration; unit length, orthogonal in the metric.

    The tangent of the branch itself is excluded by the last row. Usually there is one; two where two multipliers cross
    at once; none where (u, p) is not a branch point.
    """
    border = engine.weights * tangent
    engine.residual(u, p)
    rng = np.random.default_rng(3)
    count = min(3, engine.n)
    vectors = [engine.unit(rng.standard_normal(engine.n + 1)) for _ in range(count)]
    growth = [0.0] * count
    for _ in range(6):
        done: list[np.ndarray] = []
        for i, vector in enumerate(vectors):
            image = engine.apply_inverse(border, vector)
            if not np.all(np.isfinite(image)):
                image = vector
            for other in done:
                image = image - engine.inner(image, other) * other
                image = image - engine.inner(image, other) * other
            growth[i] = engine.norm(image)
            done.append(engine.unit(image) if growth[i] > 0.0 else vector)
        vectors = done
    scale = max(growth[-1], 1.0) if count > 2 else 1.0
    found = [v for v, g in zip(vectors, growth) if g > scale / SINGULAR]
    return found[:2]


def departures(
    engine: Engine,
    u: np.ndarray,
    p: float,
    tangent: np.ndarray,
    amplitude: float,
    one_sided: bool,
    directions: list[np.ndarray] | None = None,
) -> list[Departure]:
    """The branches that leave a branch point of the engine's problem.

    A point at distance ``amplitude`` along the null vector is corrected in the hyperplane through it; the first sweep of
    Newton's method there solves the algebraic branching equation, so the part along the known branch need not be known.

    Parameters
    ----------
    engine : Engine
        Of the problem in which the point is a branch point.
    u, p, tangent
        The point, and the tangent of the known branch.
    amplitude : float
        In the metric; halved until the point can be corrected and lies close by.
    one_sided : bool
        The other side is an image of this one.
    directions : list of ndarray, optional
        Null vectors; computed if left out.
    """
    if directions is None:
        directions = null_vectors(engine, u, p, tangent)
    if len(directions) == 2:
        a, b = directions
        angles = np.arange(8) * np.pi / 8
        directions = [np.cos(t) * a + np.sin(t) * b for t in angles]
    found: list[Departure] = []
    for direction in directions:
        departure = _depart(engine, u, p, tangent, amplitude, one_sided, direction)
        if departure is not None and not any(_same(engine, departure, other) for other in found):
            found.append(departure)
    return found


def _at(engine: Engine, z: np.ndarray, direction: np.ndarray, amplitude: float) -> Solved | None:
    border = engine.weights * direction
    guess = z + amplitude * direction
    along = direction if amplitude > 0.0 else -direction
    found = engine.solve(guess[:-1], guess[-1], border, float(border @ guess), along)
    if found is None:
        return None
    far = engine.norm(engine.join(found.u, found.p) - z) > 10.0 * abs(amplitude)
    return None if far else found


def _depart(
    engine: Engine,
    u: np.ndarray,
    p: float,
    tangent: np.ndarray,
    amplitude: float,
    one_sided: bool,
    direction: np.ndarray,
) -> Departure | None:
    z = engine.join(u, p)
    best: Departure | None = None
    for _ in range(7):
        ahead, near = _at(engine, z, direction, amplitude), _at(engine, z, direction, 0.5 * amplitude)
        back = behind = None
        if not one_sided:
            back, behind = _at(engine, z, direction, -amplitude), _at(engine, z, direction, -0.5 * amplitude)
        if ahead is not None and near is not None and (one_sided or (back is not None and behind is not None)):
            if one_sided:
                wide, narrow, slope = (ahead.p - p) / amplitude**2, (near.p - p) / (0.5 * amplitude) ** 2, 0.0
            else:
                assert back is not None and behind is not None
                wide = (0.5 * (ahead.p + back.p) - p) / amplitude**2
                narrow = (0.5 * (near.p + behind.p) - p) / (0.5 * amplitude) ** 2
                slope = (4.0 * (near.p - behind.p) - 0.5 * (ahead.p - back.p)) / (3.0 * amplitude)
            curvature = (4.0 * narrow - wide) / 3.0
            chord = engine.join(ahead.u, ahead.p) - (z if back is None else engine.join(back.u, back.p))
            origin = engine.polish(u, p, engine.weights * tangent, float(engine.weights * tangent @ z))
            if origin is None:
                return None
            origin = origin._replace(tangent=engine.unit(chord if back is not None else direction), sign=0.0)
            best = Departure(engine.problem, origin, ahead, back, direction, amplitude, curvature, slope)
            if abs(wide - narrow) <= 0.02 * abs(narrow) + 1e-9 / amplitude**2:
                return best
        amplitude *= 0.5
    return best


def _same(engine: Engine, one: Departure, other: Departure) -> bool:
    gap = engine.join(one.ahead.u, one.ahead.p) - engine.join(other.ahead.u, other.ahead.p)
    return engine.norm(gap) < 1e-3 * one.amplitude
