"""Conversion of a graph to named entries of arrays and JSON values, which the store writes, and back.

Entries that were read are checked: types by the annotations of the dataclasses, labels, lengths of arrays.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import RENAMED, kind_named
from ..branches import Branch, Ending
from ..branches.special_point import LazyNumber, SpecialPoint
from ..problems.protocol import Problem
from ..problems.registry import UnknownFactory, rebuild
from . import Graph, Switch
from .contents import Attractor, Unresolved

if TYPE_CHECKING:
    from collections.abc import Iterable

    from _typeshed import DataclassInstance

    from ..problems.protocol import Problem


Entry = tuple[str, str, dict[str, Any]]

DEEPEST = 60  # largest number of levels of nested values
_MEMBERS = ("branches", "special", "switches", "proofs", "attractors", "missing", "unresolved")


def fields_of(entry: DataclassInstance, *omitted: str) -> dict[str, Any]:
    """Return the fields of a dataclass by name, except those in `omitted`."""
    return {f.name: getattr(entry, f.name) for f in fields(entry) if f.name not in omitted}


def graph_entries(graph: Graph) -> Iterator[Entry]:
    """Generate the entries of a graph as (kind, key, content): one "graph", then "branch", "special", ... and "switch", in order."""
    yield "graph", "graph", fields_of(graph, *_MEMBERS)
    for branch in graph.branches.values():
        yield "branch", branch.label, content_of(branch)
    for point in graph.special.values():
        yield "special", point.label, content_of(point)
    for label, proof in graph.proofs.items():
        yield "proof", label, proof
    for kind, entries in (("attractor", graph.attractors), ("missing", graph.missing)):
        for number, attractor in enumerate(entries):
            yield kind, str(number), attractor.to_dict()
    for number, entry in enumerate(graph.unresolved):
        yield "unresolved", str(number), entry.to_dict()
    for i, switch in enumerate(graph.switches):
        yield "switch", str(i), fields_of(switch)


def graph_from_entries(
    entries: Mapping[str, Mapping[str, dict[str, Any]]], *, problems: bool = True, trust: bool = False
) -> Graph:
    """Rebuild a graph from the entries of `graph_entries`.

    Parameters
    ----------
    entries : mapping
        kind -> key -> content, in the order in which they were written.
    problems : bool
        Rebuild the problems of the branches, too, so that orbits and measures can be computed.
    trust : bool
        Import user functions that the entries name; see :mod:`contvines.problems.registry`.

    Raises
    ------
    ValueError
        If the entries are not those of a graph.
    """
    entries = renamed(entries)
    head = next(iter(entries.get("graph", {}).values()), {})
    graph = Graph(**{**head, "within": _pair(head["within"])} if head else {})
    built: dict[str, Any] = {}
    for label, content in entries.get("branch", {}).items():
        problem = _problem(content["description"], built, trust) if problems else None
        graph.branches[label] = branch_of(content, problem)
    for label, content in entries.get("special", {}).items():
        content = dict(content)
        content["bracket"] = _pair(content["bracket"])
        note = content.pop("note", "")  # of version 0.1
        content["remarks"] = tuple(content.get("remarks", (note,) if note else ()))
        branch = graph.branches.get(content["branch"])
        graph.special[label] = SpecialPoint(problem=branch.problem if branch else None, **content)
    graph.switches += [Switch(**content) for content in entries.get("switch", {}).values()]
    graph.proofs.update(entries.get("proof", {}))
    graph.attractors = [Attractor(**content) for content in entries.get("attractor", {}).values()]
    graph.unresolved = [Unresolved.from_dict(content) for content in entries.get("unresolved", {}).values()]
    graph.missing = [Attractor(**content) for content in entries.get("missing", {}).values()]
    check_graph(graph)
    return graph


def branch_of(content: Mapping[str, Any], problem: Problem | None) -> Branch:
    """Rebuild a branch from the result of `content_of`."""
    entry = dict(content)
    entry["endings"] = _pair(
        [Ending.from_text(text) for text in entry.pop("ended")]  # files of version 0.1 have sentences
        if "ended" in entry
        else [Ending.from_dict(ending) for ending in entry["endings"]]
    )
    if entry["description"].get("spectrum") == "none":
        entry["stable"] = None  # "unstable" in files up to version 0.1
    entry["marks"] = tuple((int(i), str(name)) for i, name in entry["marks"])
    return Branch(problem=problem, **entry)


def content_of(entry: DataclassInstance) -> dict[str, Any]:
    """Return a branch or special point as arrays and JSON values, without its problem."""
    content = fields_of(entry, "problem", "own_kind")
    if "endings" in content:
        content["endings"] = [ending.to_dict() for ending in content["endings"]]
    return content


def _pair(values: Iterable) -> tuple:
    first, second = values
    return (first, second)


def _problem(description: dict[str, Any], built: dict[str, Any], trust: bool) -> Problem | None:
    """Return the problem of a description, built once per description; None if it cannot or must not be rebuilt."""
    key = json.dumps(description, sort_keys=True, default=str)
    if key not in built:
        try:
            built[key] = rebuild(description, trust)
        except UnknownFactory:
            built[key] = None
    return built[key]


def same_graph(one: Graph, other: Graph) -> bool:
    """Whether two graphs are equal, bit for bit, apart from their problems."""
    entries, other_entries = list(graph_entries(one)), list(graph_entries(other))
    return len(entries) == len(other_entries) and all(
        a[:2] == b[:2] and a[2].keys() == b[2].keys() and all(_equal(a[2][k], b[2][k]) for k in a[2])
        for a, b in zip(entries, other_entries)
    )


def _equal(a: object, b: object) -> bool:
    """Whether two values are equal, bit for bit; NaN equals NaN."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return (
            isinstance(a, np.ndarray)
            and isinstance(b, np.ndarray)
            and a.shape == b.shape
            and a.dtype == b.dtype
            and a.tobytes() == b.tobytes()
        )
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_equal(a[k], b[k]) for k in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_equal(x, y) for x, y in zip(a, b))
    return a == b or (a != a and b != b)


Entries = Mapping[str, Mapping[str, dict[str, Any]]]


def renamed(entries: Entries) -> Entries:
    """Convert kinds and labels of entries from old files to the current ones; entries of current files are returned unchanged.

    Labels of points of codimension two are not changed, as CH is Chenciner there.
    """
    labels: dict[str, str] = {}
    for group in ("special", "locus"):
        for label, content in entries.get(group, {}).items():
            if content.get("kind") in RENAMED:
                for name in (label, content.get("seed")):
                    if isinstance(name, str):
                        new = kind_named(RENAMED[content["kind"]]).label
                        labels[name] = re.sub(r"^[A-Z]+(?=\d)", new, name)
    if not labels:
        return entries
    return {
        group: {
            (key if group == "plane-point" else labels.get(key, key)): _content(group, content, labels)
            for key, content in contents.items()
        }
        for group, contents in entries.items()
    }


def _content(group: str, content: dict[str, Any], labels: Mapping[str, str]) -> dict[str, Any]:
    """Return the content of an entry with current kinds and labels."""
    if group == "plane-point":
        return {**content, "on": _relabelled(content["on"], labels)}
    if group in ("attractor", "missing") or not isinstance(content, Mapping):
        return content
    return {
        name: value
        if group == "locus" and name == "marks"
        else RENAMED.get(value, value)
        if name in ("kind", "branch_kind") and isinstance(value, str)
        else _relabelled(value, labels)
        for name, value in content.items()
    }


def _relabelled(value: object, labels: Mapping[str, str]) -> object:
    """Return a nested value with current kinds and labels."""
    if isinstance(value, str):
        return labels.get(value, value)
    if isinstance(value, list | tuple):
        return type(value)(_relabelled(part, labels) for part in value)
    if isinstance(value, Mapping):
        return {
            name: RENAMED.get(part, part)
            if name == "kind" and isinstance(part, str)
            else _relabelled(part, labels)
            for name, part in value.items()
        }
    return value


# ------------------------------------------------------------------ checks of entries that were read
class OtherEquations(ValueError):
    """Raised if a branch and its problem have different numbers of unknowns: an older version used other equations."""


def check_graph(graph: Graph) -> None:
    """Check that a graph is complete and consistent.

    Raises
    ------
    ValueError
        If it is not; the message names the entry and the field.
    """
    check_fields("the graph", graph)
    for label, branch in graph.branches.items():
        check_branch(label, branch)
    for label, point in graph.special.items():
        check_fields(label, point)
        _check_label(label, point.label)
        if point.branch not in graph.branches:
            raise ValueError(f"{label}: its branch {point.branch!r} is missing")
        _check_shapes(label, point, u=1, tangent=1, multipliers=1)
    for switch in graph.switches:
        check_fields("a switch", switch)
        for name, labels in (
            (switch.point, graph.special),
            (switch.source, graph.branches),
            (switch.target, graph.branches),
        ):
            if name not in labels:
                raise ValueError(f"a switch names {name!r}, which is missing")
    for entry in graph.unresolved:
        check_fields("an unresolved stretch", entry)
        if entry.branch not in graph.branches:
            raise ValueError(f"an unresolved stretch lies on {entry.branch!r}, which is missing")
    for attractor in (*graph.attractors, *graph.missing):
        check_fields("an attractor", attractor)
        if not math.isfinite(attractor.value):
            raise ValueError("the value of an attractor is not finite")
    for name in ("scan", "scanned", "quiet", "followed", "unfollowed"):
        if not fits(graph.settings.get(name, 0), int):
            raise ValueError(f"settings: {name} cannot be {_shown(graph.settings[name])}")


def check_branch(label: str, branch: Branch) -> None:
    """Check a branch: types of fields, shapes of arrays, marks, and its label against that of the entry.

    Raises
    ------
    ValueError
        If something is wrong; `OtherEquations` if the problem has another number of unknowns.
    """
    check_fields(label, branch)
    _check_label(label, branch.label)
    for ending in branch.endings:
        check_fields(f"an ending of {label}", ending)
    _check_shapes(label, branch, points=2, values=1, tangents=2, multipliers=2, margin=1)
    n, size = branch.points.shape
    lengths = [len(a) for a in (branch.values, branch.tangents, branch.multipliers, branch.margin)]
    if branch.stable is not None:
        if branch.stable.ndim != 1 or branch.stable.dtype != bool:
            raise ValueError(f"{label}: stable is not an array of true and false")
        lengths.append(len(branch.stable))
    if n < 1 or any(length != n for length in lengths) or branch.tangents.shape[1] != size + 1:
        raise ValueError(f"{label}: its arrays are not of the same length")
    if branch.problem is not None and branch.problem.dimension != size:
        raise OtherEquations(
            f"{label}: its points have {size} unknowns, its problem has {branch.problem.dimension} now"
        )
    if any(not -n <= i < n for i, _ in branch.marks):
        raise ValueError(f"{label}: a mark lies on none of its points")


def check_fields(label: str, entry: DataclassInstance) -> None:
    """Check that all fields of a dataclass have the annotated types.

    Raises
    ------
    ValueError
        If one has not; the message names it.
    """
    hints = _hints(type(entry))
    for field in fields(entry):
        value = getattr(entry, field.name)
        if not fits(value, hints[field.name]):
            raise ValueError(f"{label}: {field.name} cannot be {_shown(value)}")


@cache
def _hints(kind: type) -> dict[str, Any]:
    """Return the annotations of a dataclass as types, by field."""
    from pathlib import Path  # for annotations

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
    """Whether a value has the type of an annotation; NaN and infinity count as floats."""
    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind in (Union, UnionType):
        return any(fits(value, part) for part in parts)
    if kind in (Any, Problem, Kind):  # Problem and Kind are not stored in files
        return _is_writable(value)
    if kind is LazyNumber:
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
    """Whether an integer can be converted to a float."""
    try:
        float(value)
    except OverflowError:
        return False
    return True


def _is_writable(value: object, levels: int = DEEPEST) -> bool:
    """Whether a value is nested at most `levels` deep, so that it can be written and compared."""
    if isinstance(value, Mapping):
        return levels > 0 and all(_is_writable(v, levels - 1) for v in value.values())
    if isinstance(value, list | tuple):
        return levels > 0 and all(_is_writable(v, levels - 1) for v in value)
    return not isinstance(value, int) or _finite_size(value)


def _check_label(key: str, label: str) -> None:
    """Check that a label is the key of its entry."""
    if key != label:
        raise ValueError(f"{key}: its label is {label!r}")


def _check_shapes(label: str, entry: DataclassInstance, **dimensions: int) -> None:
    """Check that arrays, by field, are numeric and have the given number of dimensions."""
    for name, dimension in dimensions.items():
        array = getattr(entry, name)
        numbers = array.dtype.kind in ("fc" if name == "multipliers" else "fi")
        if array.ndim != dimension or not numbers:
            raise ValueError(f"{label}: {name} has the shape {array.shape} and the type {array.dtype}")


def _shown(value: object) -> str:
    text = repr(value) if not is_dataclass(value) else type(value).__name__
    return text if len(text) <= 60 else f"{text[:57]}..."
