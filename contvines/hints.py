"""Hints: names that are nearly right."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Iterable
from dataclasses import fields
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from .doors import above

P = ParamSpec("P")
R = TypeVar("R")


def did_you_mean(given: Any, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, else empty."""
    close = difflib.get_close_matches(str(given)[:60], [str(name) for name in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


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
