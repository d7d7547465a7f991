"""Names in files up to version 0.2 as they are today: the border at which an event vanishes was "chatter", labelled CH."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from ..bifurcation.kinds import RENAMED, kind_named

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


def _content(group: str, content: Any, labels: Mapping[str, str]) -> Any:
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


def _relabelled(value: Any, labels: Mapping[str, str]) -> Any:
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
