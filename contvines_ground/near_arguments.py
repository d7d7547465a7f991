"""Arguments that a function does not have are refused with a hint."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from contvines_ground.near_names import did_you_mean

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")
Elsewhere = Callable[[str, Any, Sequence[str]], str]


def hinting(function: Callable[P, R], elsewhere: Elsewhere | None = None) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has.

    A method is called by its class, too, and what makes a thing (``__init__``) by the name of its class alone.

    Parameters
    ----------
    function : callable
        One that takes any arguments is returned as it is: it hands them on.
    elsewhere : callable, optional
        (name, value, known names) -> where the argument belongs, in words, or nothing.
    """
    known = inspect.signature(function).parameters
    names = [name for name, entry in known.items() if entry.kind is not entry.VAR_KEYWORD]
    if len(names) < len(known):
        return function
    called = function.__qualname__.rpartition("<locals>.")[2].removesuffix(".__init__")
    shown = names[1:] if names[:1] in (["self"], ["cls"]) else names

    @wraps(function)
    def asked(*arguments: P.args, **options: P.kwargs) -> R:
        for name in options:
            if name not in names:
                hint = elsewhere(name, options[name], names) if elsewhere is not None else ""
                hint = hint or (f"it has {', '.join(shown)}" if shown else "it takes none")
                raise TypeError(f"{called} has no argument {name!r}{did_you_mean(name, shown)}; {hint}")
        return function(*arguments, **options)

    return asked


def hinted(thing: type[T], elsewhere: Elsewhere | None = None) -> type[T]:
    """The class; its public methods, and what makes it, are `hinting`."""
    for name, member in list(vars(thing).items()):
        if inspect.isfunction(member) and (name == "__init__" or not name.startswith("_")):
            setattr(thing, name, hinting(member, elsewhere))
        elif isinstance(member, classmethod) and not name.startswith("_"):
            setattr(thing, name, classmethod(hinting(member.__func__, elsewhere)))
    return thing
