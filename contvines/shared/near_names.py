"""Names that are nearly right."""

import difflib
import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import Any, ParamSpec, TypeVar


def did_you_mean(given: object, known: Iterable[str]) -> str:
    """ " (did you mean ...?)" where one of the known names is close, or the same but for capitals, else empty."""
    asked, names = str(given)[:60], [str(name) for name in known]
    close = [name for name in names if name.lower() == asked.lower()]
    close = close or difflib.get_close_matches(asked, names, n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


# what machines are asked beside their parameters, which share one list of keywords with these
ASKED = ("word", "periods", "guess", "start", "count", "seed", "size", "time", "events", "over")


def no_parameter(given: object, machine: str, known: Iterable[str]) -> str:
    """The sentence that a machine has no such parameter, and which it has."""
    names = list(known)
    return f"{given} is no parameter of {machine}{did_you_mean(given, [name for name in (*names, *ASKED) if name != given])}; it has {', '.join(names)}"


P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")
Elsewhere = Callable[[str, Any, Sequence[str]], str]


def hinting(function: Callable[P, R], elsewhere: Elsewhere | None = None) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has, a missing one with its meaning.

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
        try:
            return function(*arguments, **options)
        except TypeError:
            wrong = next((name for name in options if name not in names), None)
            absent = _absent(known, arguments, options)
            if wrong is None and not absent:
                raise
        if wrong is not None:
            hint = elsewhere(wrong, options[wrong], names) if elsewhere is not None else ""
            hint = hint or (f"it has {', '.join(shown)}" if shown else "it takes none")
            raise TypeError(f"{called} has no argument {wrong!r}{did_you_mean(wrong, shown)}; {hint}")
        needed = " and ".join(
            f"{name} ({meaning})" if meaning else name
            for name, meaning in ((name, _meaning(inspect.getdoc(function), name)) for name in absent)
        )
        raise TypeError(f"{called} needs {needed}")

    return asked


def _absent(
    known: Mapping[str, inspect.Parameter], arguments: Sequence[Any], options: Mapping[str, Any]
) -> list[str]:
    """The names of arguments that have to be given and are not."""
    by_position = [name for name, entry in known.items() if entry.kind <= entry.POSITIONAL_OR_KEYWORD]
    given = {*by_position[: len(arguments)], *options}
    return [
        name
        for name, entry in known.items()
        if entry.default is entry.empty and entry.kind is not entry.VAR_POSITIONAL and name not in given
    ]


def _meaning(page: str | None, name: str) -> str:
    """What a docstring in numpydoc says of an argument, up to the end of its first sentence; nothing if it is silent."""
    entry = re.search(rf"^{name} : .*\n((?: {{4}}.*\n?)+)", page or "", re.MULTILINE)
    return re.split(r"[.;](?:\s|$)", " ".join(entry[1].split()))[0] if entry else ""


def hinted(thing: type[T], elsewhere: Elsewhere | None = None) -> type[T]:
    """The class; its public methods, and what makes it, are `hinting`."""
    for name, member in list(vars(thing).items()):
        if inspect.isfunction(member) and (name == "__init__" or not name.startswith("_")):
            setattr(thing, name, hinting(member, elsewhere))
        elif isinstance(member, classmethod) and not name.startswith("_"):
            setattr(thing, name, classmethod(hinting(member.__func__, elsewhere)))
    return thing
