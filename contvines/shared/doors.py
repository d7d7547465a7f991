"""Doors that lead up: what users ask of a thing, and what is built on it.

``graph.plot()``, ``machine.orbit(...)`` or ``orbit.problem()`` lead to rooms that know the thing and that the thing must not know. Here
nothing is known, either: each package, which stands above all its rooms, says when it is imported what lies behind each of its doors.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any


class Doors:
    """The doors of one package."""

    def __init__(self) -> None:
        self._places: dict[str, str] = {}

    def lead(self, places: Mapping[str, str]) -> None:
        """Say what lies behind doors: name -> "module:function"."""
        self._places.update(places)

    def above(self, name: str) -> Any:
        """The function or class behind a door; imported when it is first opened."""
        module, _, place = self._places[name].partition(":")
        return getattr(import_module(module), place)
