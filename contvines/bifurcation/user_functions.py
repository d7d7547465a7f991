"""Test functions of users, as arrays of many points: those of their kinds, and functions of which zeros are labelled US."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import Chunk
from .kind import Kind
from .kind_answers import number_of
from .point_on_branch import PointOnBranch

UserFunction = Callable[[np.ndarray, float], float] | tuple[str, float]
"""A number of a solution (u, p), or a measure by name and the value at which it is asked for."""


class Own(NamedTuple):
    """A kind of the user's with the name of the function, the values of its test at the points of a chunk, and at one point."""

    kind: Kind
    name: str
    values: Callable[[Chunk], np.ndarray]
    at: Callable[[Solved], float]


def own_tests(
    engine: Engine,
    kinds: Iterable[Kind],
    functions: Mapping[str, UserFunction],
    stops: Iterable[str],
    user: Kind,
) -> list[Own]:
    """Tests of the kinds that have one, and of functions by name (kind `user`); branches end at zeros of those named in `stops`."""
    found = [_of_kind(engine, kind) for kind in kinds if kind.test is not None]
    for name, function in functions.items():
        kind = Kind(user.name, user.label, text=user.text, ends=name in stops)
        found.append(_of_function(engine, kind, name, function))
    return found


def _of_kind(engine: Engine, kind: Kind) -> Own:
    test = kind.test
    assert test is not None

    def at(point: Solved) -> float:
        return number_of(
            kind, "test", test, PointOnBranch(engine, point), {engine.problem.parameter: point.p}
        )

    return Own(kind, "", lambda chunk: np.array([at(chunk.solved(i)) for i in range(len(chunk))]), at)


def _of_function(engine: Engine, kind: Kind, name: str, function: UserFunction) -> Own:
    """`function` is a callable (u, p) -> float, or a pair (name of a measure, value): zero where the measure has the value."""
    of = _many(engine, function)
    return Own(
        kind,
        name,
        lambda chunk: np.asarray(of(chunk.points, chunk.values)),
        lambda point: float(of(point.u[None, :], np.array([point.p]))[0]),
    )


def _many(engine: Engine, function: UserFunction) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    problem = engine.problem
    if callable(function):
        return lambda points, values: np.array([float(function(u, float(p))) for u, p in zip(points, values)])
    try:
        measure, value = function[0], float(function[1])
    except (TypeError, ValueError, IndexError):
        raise ValueError(
            f"user function {function!r} must be a callable (u, p) -> float or a pair (measure, value)"
        ) from None
    if measure == problem.parameter:
        return lambda points, values: values - value
    return lambda points, values: problem.measures((measure,), points, values)[measure] - value
