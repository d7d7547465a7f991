"""Hints in error messages for misspelt names, unknown arguments and missing arguments."""

import difflib
import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import Any, ParamSpec, TypeVar


def did_you_mean(given: object, known: Iterable[str]) -> str:
    """Return " (did you mean ...?)" if a known name is similar, or equal apart from capitals; otherwise an empty text."""
    asked, names = str(given)[:60], [str(name) for name in known]
    close = [name for name in names if name.lower() == asked.lower()]
    close = close or difflib.get_close_matches(asked, names, n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


# keyword arguments of machines' methods besides parameters; both share one list of keywords
ASKED = ("word", "periods", "guess", "start", "count", "seed", "size", "time", "events", "over")


def no_parameter(given: object, machine: str, known: Iterable[str]) -> str:
    """Return the error message that a machine lacks a parameter, with the names of those that it has."""
    names = list(known)
    return f"{given} is no parameter of {machine}{did_you_mean(given, [name for name in (*names, *ASKED) if name != given])}; it has {', '.join(names)}"


P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")
Elsewhere = Callable[[str, Any, Sequence[str]], str]


def hinting(function: Callable[P, R], elsewhere: Elsewhere | None = None) -> Callable[P, R]:
    """Decorate a function with better errors: an unknown argument lists the known names, a missing one quotes its meaning from the docstring.

    Messages name a method with its class, and ``__init__`` by its class alone.

    Parameters
    ----------
    function : callable
        A function with ``**options`` is returned unchanged.
    elsewhere : callable, optional
        ``elsewhere(name, value, known_names)`` returns a text on where an unknown argument belongs, or an empty text.
    """
    parameters = inspect.signature(function).parameters
    names = [name for name, entry in parameters.items() if entry.kind is not entry.VAR_KEYWORD]
    if len(names) < len(parameters):
        return function
    called = function.__qualname__.rpartition("<locals>.")[2].removesuffix(".__init__")
    listed = names[1:] if names[:1] in (["self"], ["cls"]) else names

    @wraps(function)
    def asked(*arguments: P.args, **options: P.kwargs) -> R:
        try:
            return function(*arguments, **options)
        except TypeError:
            wrong = next((name for name in options if name not in names), None)
            absent = _missing(parameters, arguments, options)
            if wrong is None and not absent:
                raise
        if wrong is not None:
            hint = elsewhere(wrong, options[wrong], names) if elsewhere is not None else ""
            hint = hint or (f"it has {', '.join(listed)}" if listed else "it takes none")
            raise TypeError(f"{called} has no argument {wrong!r}{did_you_mean(wrong, listed)}; {hint}")
        needed = " and ".join(
            f"{name} ({meaning})" if meaning else name
            for name, meaning in ((name, _meaning(inspect.getdoc(function), name)) for name in absent)
        )
        spare = len(arguments) - sum(x.kind <= x.POSITIONAL_OR_KEYWORD for x in parameters.values())
        raise TypeError(f"{called} needs {needed}" + (f", by name: {absent[0]}=..." if spare > 0 else ""))

    return asked


def _missing(
    parameters: Mapping[str, inspect.Parameter], arguments: Sequence[Any], options: Mapping[str, Any]
) -> list[str]:
    """Return the names of required arguments that are missing."""
    by_position = [name for name, entry in parameters.items() if entry.kind <= entry.POSITIONAL_OR_KEYWORD]
    given = {*by_position[: len(arguments)], *options}
    return [
        name
        for name, entry in parameters.items()
        if entry.default is entry.empty and entry.kind is not entry.VAR_POSITIONAL and name not in given
    ]


def _meaning(page: str | None, name: str) -> str:
    """Return the first sentence about an argument in a numpydoc docstring; an empty text if there is none."""
    entry = re.search(rf"^{name} : .*\n((?: {{4}}.*\n?)+)", page or "", re.MULTILINE)
    return re.split(r"[.;](?:\s|$)", " ".join(entry[1].split()))[0] if entry else ""


def hinted(thing: type[T], elsewhere: Elsewhere | None = None) -> type[T]:
    """Decorate the public methods and ``__init__`` of a class with `hinting`."""
    for name, member in list(vars(thing).items()):
        if inspect.isfunction(member) and (name == "__init__" or not name.startswith("_")):
            setattr(thing, name, hinting(member, elsewhere))
        elif isinstance(member, classmethod) and not name.startswith("_"):
            setattr(thing, name, classmethod(hinting(member.__func__, elsewhere)))
    return thing
