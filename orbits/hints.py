"""Hints: names that are nearly right."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

# what machines are asked beside their parameters, which share one list of keywords with these
ASKED = ("word", "periods", "guess", "start", "count", "seed", "size", "time", "events", "over")


def did_you_mean(given: Any, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, else empty."""
    close = difflib.get_close_matches(str(given)[:60], [str(name) for name in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


def no_parameter(given: Any, machine: str, known: Iterable[str]) -> str:
    """The sentence that a machine has no such parameter, and which it has."""
    names = list(known)
    return f"{given} is no parameter of {machine}{did_you_mean(given, [*names, *ASKED])}; it has {', '.join(names)}"


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has."""
    known = inspect.signature(function).parameters
    names = [name for name, entry in known.items() if entry.kind is not entry.VAR_KEYWORD]
    if len(names) < len(known):
        return function  # whatever else it is given it hands on
    called = function.__qualname__.removesuffix(".__init__")
    shown = names[1:] if names[:1] == ["self"] else names

    @wraps(function)
    def asked(*arguments: P.args, **options: P.kwargs) -> R:
        for name in options:
            if name not in names:
                raise TypeError(
                    f"{called} has no argument {name!r}{did_you_mean(name, shown)}; it has {', '.join(shown)}"
                )
        return function(*arguments, **options)

    return asked


def hinted(thing: type[T]) -> type[T]:
    """The class, made of arguments that are `hinting`."""
    thing.__init__ = hinting(thing.__init__)
    return thing
