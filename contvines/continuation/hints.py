"""Arguments that a function does not have are refused with a hint; those that are settings are told their place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import ParamSpec, TypeVar

from contvines.shared import near_arguments

from .settings import Settings

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has.

    The names of its settings are known, too: they belong into ``settings``.
    """
    return near_arguments.hinting(function, _setting)


def hinted(thing: type[T]) -> type[T]:
    """The class; its public methods, and what makes it, are `hinting`."""
    return near_arguments.hinted(thing, _setting)


def _setting(name: str, value: object, known: Sequence[str]) -> str:
    if "settings" not in known or name not in [field.name for field in fields(Settings)]:
        return ""
    return f"it is a setting: use settings={{{name!r}: {value!r}}}"
