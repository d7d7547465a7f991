"""Whether what was read from a file is what this program writes: types by the annotations of the dataclasses, labels, lengths of arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from ..bifurcation.kind import Kind
from ..branches.branch import Branch
from ..branches.special_point import Later, SpecialPoint
from ..problems.protocol import Problem
from .graph import Graph

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

DEEPEST = 60  # levels of nested values


class OtherEquations(ValueError):
    """A branch whose points have another number of unknowns than its problem: an older version had other equations for it."""


def check_graph(graph: Graph) -> None:
    """Refuse a graph that cannot be shown.

    Raises
    ------
    ValueError
        The sentence names the entry and the field.
    """
    check_fields("the graph", graph)
    for label, branch in graph.branches.items():
        check_branch(label, branch)
    for label, point in graph.special.items():
        check_fields(label, point)
        _own_label(label, point.label)
        if point.branch not in graph.branches:
            raise ValueError(f"{label}: its branch {point.branch!r} is missing")
        _shaped(label, point, u=1, tangent=1, multipliers=1)
    for switch in graph.switches:
        check_fields("a switch", switch)
        for name, known in (
            (switch.point, graph.special),
            (switch.source, graph.branches),
            (switch.target, graph.branches),
        ):
            if name not in known:
                raise ValueError(f"a switch names {name!r}, which is missing")
    for entry in graph.unresolved:
        check_fields("an unresolved stretch", entry)
        if entry.branch not in graph.branches:
            raise ValueError(f"an unresolved stretch lies on {entry.branch!r}, which is missing")
    for attractor in (*graph.attractors, *graph.missing):
        check_fields("an attractor", attractor)
        if not math.isfinite(attractor.value):
            raise ValueError("an attractor has no place")
    for name in ("scan", "scanned", "quiet", "followed", "unfollowed"):
        if not fits(graph.settings.get(name, 0), int):
            raise ValueError(f"settings: {name} cannot be {_shown(graph.settings[name])}")


def check_branch(label: str, branch: Branch) -> None:
    """Refuse a branch that cannot be shown, or whose label is not the one under which it was kept.

    Raises
    ------
    ValueError
    """
    check_fields(label, branch)
    _own_label(label, branch.label)
    for ending in branch.endings:
        check_fields(f"an ending of {label}", ending)
    _shaped(label, branch, points=2, values=1, tangents=2, multipliers=2, margin=1)
    n, size = branch.points.shape
    lengths = [len(a) for a in (branch.values, branch.tangents, branch.multipliers, branch.margin)]
    if branch.stable is not None:
        if branch.stable.ndim != 1 or branch.stable.dtype != bool:
            raise ValueError(f"{label}: stable is no row of true and false")
        lengths.append(len(branch.stable))
    if n < 1 or any(length != n for length in lengths) or branch.tangents.shape[1] != size + 1:
        raise ValueError(f"{label}: its arrays are not of the same length")
    if branch.problem is not None and branch.problem.dimension != size:
        raise OtherEquations(
            f"{label}: its points have {size} unknowns, its problem has {branch.problem.dimension} now"
        )
    if any(not -n <= i < n for i, _ in branch.marks):
        raise ValueError(f"{label}: a mark lies on none of its points")


def check_fields(label: str, thing: DataclassInstance) -> None:
    """Refuse an instance of a dataclass with a field that is not of its type.

    Raises
    ------
    ValueError
    """
    hints = _hints(type(thing))
    for field in fields(thing):
        value = getattr(thing, field.name)
        if not fits(value, hints[field.name]):
            raise ValueError(f"{label}: {field.name} cannot be {_shown(value)}")


@cache
def _hints(kind: type) -> dict[str, Any]:
    from pathlib import Path  # named in annotations only

    return get_type_hints(
        kind,
        localns={
            "Path": Path,
            "Problem": Problem,
            "Branch": Branch,
            "SpecialPoint": SpecialPoint,
            "Kind": Kind,
        },
    )


def fits(value: object, hint: object) -> bool:
    """Whether a value has the type of an annotation; numbers that are no numbers or infinite count as numbers."""
    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind in (Union, UnionType):
        return any(fits(value, part) for part in parts)
    if kind in (Any, Problem, Kind):  # what a file cannot hold is none of its
        return _plain(value)
    if kind is Later:
        return value is None or fits(value, float)
    if kind is NoneType or hint is None:
        return value is None
    if kind is float:
        return (type(value) is int or type(value) is float) and _finite_size(value)
    if kind is int:
        return type(value) is int and _finite_size(value)
    if kind is tuple:
        if not isinstance(value, tuple):
            return False
        if len(parts) == 2 and parts[1] is ...:
            return all(fits(part, parts[0]) for part in value)
        return len(value) == len(parts) and all(map(fits, value, parts))
    if kind is list:
        return isinstance(value, list) and all(fits(part, parts[0]) for part in value)
    if kind is dict:
        return isinstance(value, dict) and all(
            fits(k, parts[0]) and fits(v, parts[1]) for k, v in value.items()
        )
    if kind is np.ndarray:
        return isinstance(value, np.ndarray)
    return isinstance(kind, type) and isinstance(value, kind)


def _finite_size(value: float) -> bool:
    """Whether a whole number fits a float."""
    try:
        float(value)
    except OverflowError:
        return False
    return True


def _plain(value: object, levels: int = DEEPEST) -> bool:
    """Whether a value of any type is nested so little that it can be written and compared."""
    if isinstance(value, Mapping):
        return levels > 0 and all(_plain(v, levels - 1) for v in value.values())
    if isinstance(value, list | tuple):
        return levels > 0 and all(_plain(v, levels - 1) for v in value)
    return not isinstance(value, int) or _finite_size(value)


def _own_label(key: str, label: str) -> None:
    if key != label:
        raise ValueError(f"{key}: its label is {label!r}")


def _shaped(label: str, thing: DataclassInstance, **dimensions: int) -> None:
    for name, dimension in dimensions.items():
        array = getattr(thing, name)
        numbers = array.dtype.kind in ("fc" if name == "multipliers" else "fi")
        if array.ndim != dimension or not numbers:
            raise ValueError(f"{label}: {name} has the shape {array.shape} and the type {array.dtype}")


def _shown(value: object) -> str:
    text = repr(value) if not is_dataclass(value) else type(value).__name__
    return text if len(text) <= 60 else f"{text[:57]}..."


__all__ = ["check_branch", "check_fields", "check_graph", "fits"]
