"""Doors that lead up: what users ask of a thing, and what is built on it.

``machine.orbit(...)``, ``attractor.orbit``, ``orbit.problem()`` or ``orbit.plot()`` lead to rooms that know the thing and that the thing
must not know. Here nothing is known, either: the package itself, which stands above all its rooms, says when it is imported what lies
behind each door.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

_PLACES: dict[str, str] = {}


def lead(places: Mapping[str, str]) -> None:
    """Say what lies behind doors: name -> "module:function"."""
    _PLACES.update(places)


def above(name: str) -> Any:
    """The function or class behind a door; imported when it is first opened."""
    module, _, place = _PLACES[name].partition(":")
    return getattr(import_module(module), place)
