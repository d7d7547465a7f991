"""A graph as named entries of arrays and JSON values, and back: what the store writes and reads."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.kinds import RENAMED, kind_named
from ..branches.branch import Branch
from ..branches.ending import Ending
from ..branches.special_point import SpecialPoint
from ..problems.registry import UnknownFactory, rebuild
from .attractor import Attractor
from .graph import Graph, Switch
from .unresolved import Unresolved
from .well_formed import check_graph

if TYPE_CHECKING:
    from collections.abc import Iterable

    from _typeshed import DataclassInstance

    from ..problems.protocol import Problem

Entry = tuple[str, str, dict[str, Any]]

_MEMBERS = ("branches", "special", "switches", "proofs", "attractors", "missing", "unresolved")


def fields_of(thing: DataclassInstance, *apart: str) -> dict[str, Any]:
    """The fields of a dataclass by name, but for those apart."""
    return {f.name: getattr(thing, f.name) for f in fields(thing) if f.name not in apart}


def graph_entries(graph: Graph) -> Iterator[Entry]:
    """The graph as (kind, key, content): one "graph", then every "branch", "special" and "switch" in order."""
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
    """The graph that `graph_entries` took apart.

    Parameters
    ----------
    entries : contents by kind and key, in the order in which they were written.
    problems : rebuild the problems of the branches, so that orbits and measures can be obtained.
    trust : import functions of the user's that the branches name (see :mod:`contvines.problems.registry`).

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
    """The branch that `content_of` took apart."""
    own = dict(content)
    own["endings"] = _pair(
        [Ending.said(text) for text in own.pop("ended")]  # version 0.1 kept the sentences
        if "ended" in own
        else [Ending.from_dict(ending) for ending in own["endings"]]
    )
    if own["description"].get("spectrum") == "none":
        own["stable"] = None  # files up to 0.1 called it unstable
    own["marks"] = tuple((int(i), str(name)) for i, name in own["marks"])
    return Branch(problem=problem, **own)


def content_of(thing: DataclassInstance) -> dict[str, Any]:
    """A branch or special point as arrays and JSON values, its problem apart."""
    content = fields_of(thing, "problem", "own_kind")
    if "endings" in content:
        content["endings"] = [ending.to_dict() for ending in content["endings"]]
    return content


def _pair(values: Iterable) -> tuple:
    first, second = values
    return (first, second)


def _problem(description: dict[str, Any], built: dict[str, Any], trust: bool) -> Problem | None:
    """The problem that a description names, once per description; None if it cannot or must not be rebuilt."""
    key = json.dumps(description, sort_keys=True, default=str)
    if key not in built:
        try:
            built[key] = rebuild(description, trust)
        except UnknownFactory:
            built[key] = None
    return built[key]


def same_graph(one: Graph, other: Graph) -> bool:
    """Whether two graphs hold the same numbers, bit for bit, problems aside."""
    mine, theirs = list(graph_entries(one)), list(graph_entries(other))
    return len(mine) == len(theirs) and all(
        a[:2] == b[:2] and a[2].keys() == b[2].keys() and all(_equal(a[2][k], b[2][k]) for k in a[2])
        for a, b in zip(mine, theirs)
    )


def _equal(a: object, b: object) -> bool:
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
    """Entries of a graph or chart with today's kinds and labels; those of today's files as they are.

    Labels of points of codimension two, among which CH is Chenciner, stay.
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
