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
T = TypeVar("T")


def did_you_mean(given: Any, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, else empty."""
    close = difflib.get_close_matches(str(given)[:60], [str(name) for name in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has.

    The names of its settings are known, too: they belong into ``settings``. A method is called by its class, too, and what makes a
    thing (``__init__``) by the name of its class alone.
    """
    known = inspect.signature(function).parameters
    names = [name for name, entry in known.items() if entry.kind is not entry.VAR_KEYWORD]
    if len(names) < len(known):
        return function  # whatever else it is given it hands on
    called = function.__qualname__.rpartition("<locals>.")[2].removesuffix(".__init__")
    shown = names[1:] if names[:1] in (["self"], ["cls"]) else names

    @wraps(function)
    def asked(*arguments: P.args, **options: P.kwargs) -> R:
        for name in options:
            if name in names:
                continue
            Settings = above("Settings")

            if "settings" in names and name in [field.name for field in fields(Settings)]:
                hint = f"it is a setting: settings={{{name!r}: {options[name]!r}}} would do"
            else:
                hint = f"it has {', '.join(shown)}" if shown else "it takes none"
            raise TypeError(f"{called} has no argument {name!r}{did_you_mean(name, shown)}; {hint}")
        return function(*arguments, **options)

    return asked


def hinted(thing: type[T]) -> type[T]:
    """The class; its public methods, and what makes it, are `hinting`."""
    for name, member in list(vars(thing).items()):
        if inspect.isfunction(member) and (name == "__init__" or not name.startswith("_")):
            setattr(thing, name, hinting(member))
        elif isinstance(member, classmethod) and not name.startswith("_"):
            setattr(thing, name, classmethod(hinting(member.__func__)))
    return thing
