"""Factories that rebuild a problem from its description in a file: a fixed list, and those a program registers.

Files are data: a description names a factory, and the name is looked up in this list; a file cannot cause an import or a call of other
code. A user's functions that a file names (those of an :class:`~contvines.AlgebraicProblem`) are found if this program has already made a
problem from them; otherwise they are imported only with ``trust``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .protocol import Problem


#: Factories of this package's problems: name in a file -> "module:function" of (description, trust). Names of earlier versions are kept
#: so that their files can be read.
FACTORIES = {
    "contvines.flows.files:from_description": "contvines.flows.files:from_description",
    "contvines.loci.adaptive:from_description": "contvines.loci.adaptive:from_description",
    "contvines.loci.problem:from_description": "contvines.loci.problem:from_description",
    "contvines.problems.algebraic:from_description": "contvines.problems.algebraic:from_description",
    "contvines.problems.maps:from_description": "contvines.problems.maps:from_description",
    "contvines.algebraic:from_description": "contvines.problems.algebraic:from_description",
    "contvines.map_problem:from_description": "contvines.problems.maps:from_description",
}
#: Package with further ``FACTORIES``.
PROVIDER = "orbits"

_added: dict[str, Callable[..., Any]] = {}
_callables: dict[str, Callable] = {}


class UnknownFactory(ValueError):
    """A description names a factory that is not on the list."""


def register(name: str, build: Callable[..., Any]) -> None:
    """Add a factory for problems whose ``describe()["factory"]`` is `name`.

    Parameters
    ----------
    name : str
    build : callable
        (description, trust) -> problem; ``description`` is the result of ``describe()``, ``trust`` whether functions that
        it names may be imported.
    """
    _added[str(name)] = build


def factory(name: object) -> Callable[..., Any]:
    """Return the factory of a given name.

    Raises
    ------
    UnknownFactory
        If there is none.
    """
    if isinstance(name, str):
        if name in _added:
            return _added[name]
        listed: Mapping[str, str] = FACTORIES if name in FACTORIES else _provided()
        if name in listed:
            module, _, function = listed[name].partition(":")
            return getattr(import_module(module), function)
    quoted = repr(name) if len(repr(name)) <= 80 else repr(name)[:77] + "..."
    raise UnknownFactory(
        f"the file names the factory {quoted}, which is not on the list of factories; it was not called "
        "(contvines.register(name, function) adds one of your own)"
    )


def _provided() -> Mapping[str, str]:
    try:
        return import_module(PROVIDER).FACTORIES
    except ModuleNotFoundError as error:
        if error.name and PROVIDER.startswith(error.name):
            return {}  # the package is not installed
        raise


def rebuild(description: Mapping[str, Any], trust: bool = False) -> Problem | None:
    """Rebuild the problem of a description; None if it needs functions of the user that cannot be found.

    Parameters
    ----------
    description : mapping
        With "factory": a name known to :func:`factory`, or None.
    trust : bool
        Import functions that the description names. Only for files from a trusted source: importing runs their code.

    Raises
    ------
    UnknownFactory
        If the factory is not on the list.
    ValueError
        If the description does not describe a problem.
    """
    name = description.get("factory")
    if not name:
        return None
    build = factory(name)
    try:
        return build(description, trust)
    except (KeyError, TypeError, IndexError, AttributeError, OverflowError) as error:
        raise ValueError(
            f"a problem's description cannot be understood ({type(error).__name__}: {error})"
        ) from None


def address(f: Callable) -> str | None:
    """Return "module:name" under which a callable can be imported, or None; registers the callable under this address."""
    module, name = getattr(f, "__module__", None), getattr(f, "__qualname__", "")
    if not module or module == "__main__" or "<" in name or not name:
        return None
    path = f"{module}:{name}"
    _callables[path] = f
    return path


def addresses(given: Mapping[str, Any]) -> tuple[dict[str, Any], bool]:
    """Return the addresses of callables by role, and whether all callables have one.

    Parameters
    ----------
    given : mapping of role to callable, mapping of callables, array (a mirror given as a matrix) or None
    """
    found_at: dict[str, Any] = {}
    found: list[str | None] = []
    for role, f in given.items():
        if isinstance(f, Mapping):
            found_at[role] = {name: address(part) for name, part in f.items()}
            found += found_at[role].values()
        elif f is not None and not callable(f):
            found_at[role] = [list(map(float, row)) if hasattr(row, "__len__") else int(row) for row in f]
        else:
            found_at[role] = None if f is None else address(f)
            found += [] if f is None else [found_at[role]]
    return found_at, all(place is not None for place in found)


def find_callables(paths: Mapping[str, object] | Sequence[object], trust: bool) -> dict[str, Any] | None:
    """Return the callables at the addresses of a description; None if one of them cannot be found.

    A callable is found if this program has made a problem from it or, with ``trust``, if it can be imported.

    Parameters
    ----------
    paths : mapping of role to an address, to a mapping of addresses, to numbers (a mirror given as a matrix) or None
        (In version 0.1 a list of addresses for maps.)
    trust : bool
        Import callables that are not registered.

    Raises
    ------
    ValueError
        If a callable cannot be imported.
    """
    roles = paths if isinstance(paths, Mapping) else dict(zip(("F", "jacobian", "derivative"), paths))
    found: dict[str, Any] = {}
    for role, place in roles.items():
        if isinstance(place, Mapping):
            found[role] = {name: _find(part, trust) for name, part in place.items()}
            missing = None in found[role].values()
        else:
            found[role] = _find(place, trust) if isinstance(place, str) else place
            missing = isinstance(place, str) and found[role] is None
        if missing:
            return None
    return found


def _find(path: str, trust: bool) -> Callable | None:
    registered = _callables.get(path)
    if registered is not None or not trust:
        return registered
    module, _, name = path.partition(":")
    try:
        found: object = import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError, ValueError) as error:
        raise ValueError(f"the function {path!r} that the file names cannot be imported ({error})") from None
    if not callable(found):
        raise ValueError(f"the function {path!r} that the file names is none")
    return found


def without_problem(label: str, description: Mapping[str, Any] | None = None) -> str:
    """Return the message for a branch or point that was loaded without its problem: the reason and a remedy."""
    try:
        named = bool(description and description.get("factory") and factory(description["factory"]))
    except UnknownFactory as error:
        return f"{label} has no problem attached: {error}"
    if description is None:
        return (
            f"{label} has no problem attached: make the problem and call graph.attach(problem), or load the file with trust=True (--trust) "
            "if you trust its source; even then, functions that cannot be imported by a name (lambdas, functions of a script) are not loaded"
        )
    if named:
        return (
            f"{label} has no problem attached: a function of your own is not imported because a file names it; make the "
            "problem and call graph.attach(problem), or load the file with trust=True (--trust) if you trust its source"
        )
    return (
        f"{label} has no problem attached: its graph was saved from functions that cannot be imported by a name (lambdas, or "
        "functions of a script that is itself run); put them into a module of their own, or attach the problem with graph.attach(problem)"
    )
