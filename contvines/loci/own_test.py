"""Users' kinds in two parameters: which points are of them, and their tests on loci."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kind_answers import number_of
from ..bifurcation.kinds import BY_NAME
from ..branches.special_point import SpecialPoint
from .plane import Plane
from .point_of_locus import PointOfLocus


def of_plane(plane: Plane) -> PointOfLocus:
    """The point at which a plane is."""
    u, p, q = plane.place
    locus, line = plane.locus, plane.first

    def jacobian() -> np.ndarray:
        if line.kernels.matrix is None:
            raise ValueError(f"a {type(line.problem).__name__} does not tell its Jacobian")
        line.at(u, p)
        return line.kernels.matrix(line.data, line.work)

    place = {locus.inner: float(p), locus.over: float(q)}
    return PointOfLocus(lambda: locus.at(q), locus.base.parameters, place, u, plane.row, jacobian)


def tested(kind: Kind, plane: Plane) -> float:
    """A user's test at the point at which a plane is."""
    assert kind.test is not None
    point = of_plane(plane)
    return number_of(kind, "test", kind.test, point, point.place)


def of_own_kind(point: SpecialPoint) -> bool:
    """Whether a special point is of a kind of the user's own; a problem's own borders are not."""
    return point.own_kind is not None or (point.kind not in BY_NAME and point.margin_index is None)


def followed(point: SpecialPoint) -> bool:
    """Whether a chart follows a special point: all but ends, and zeros of users' tests."""
    return point.kind not in ("end", "user") and not of_own_kind(point)


def condition_of(point: SpecialPoint, kinds: Iterable[Kind]) -> Kind:
    """The kind of a point of a user's kind: its own, or, of a point from a file, the one of this name.

    Raises
    ------
    ValueError
        If it brings no condition.
    """
    kind = point.own_kind or next((kind for kind in kinds if kind.name == point.kind), None)
    if kind is None:
        raise ValueError(
            f"{point.label}: files do not keep functions of kinds of your own; give the kind again, in Python: "
            f"contvines.locus(graph[{point.label!r}], ..., kinds=[*contvines.KINDS, yours])"
        )
    if not callable(kind.locus):
        raise ValueError(
            f"{point.label}: its kind has no condition to follow; Kind(..., locus=lambda point: ...) gives it one, often its test"
        )
    return kind
