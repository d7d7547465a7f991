"""Arguments that a function does not have are refused with a hint."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from functools import wraps
from typing import ParamSpec, TypeVar

from contvines_ground.near_names import did_you_mean

from .doors import above

P = ParamSpec("P")
R = TypeVar("R")


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has.

    The names of its settings are known, too: they belong into ``settings``.
    """
    known = inspect.signature(function).parameters
    names = [name for name, entry in known.items() if entry.kind is not entry.VAR_KEYWORD]
    if len(names) < len(known):
        return function  # whatever else it is given it hands on

    @wraps(function)
    def asked(*arguments: P.args, **options: P.kwargs) -> R:
        for name in options:
            if name in names:
                continue
            Settings = above("Settings")

            if "settings" in names and name in [field.name for field in fields(Settings)]:
                hint = f"it is a setting: settings={{{name!r}: {options[name]!r}}} would do"
            else:
                hint = f"it has {', '.join(names)}"
            raise TypeError(
                f"{function.__name__} has no argument {name!r}{did_you_mean(name, names)}; {hint}"
            )
        return function(*arguments, **options)

    return asked
