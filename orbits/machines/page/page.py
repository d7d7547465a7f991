"""The page behind a declared machine: its file, its text, and whether it has changed since."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, overload

from contvines.shared.files import module_of

if TYPE_CHECKING:
    from typing import NoReturn

    from orbits.symbols import Plain


class FromPage(Protocol):
    """What a page has declared."""

    @property
    def page(self) -> Page: ...


@dataclass(frozen=True)
class Page:
    """Where a machine was declared.

    Attributes
    ----------
    path : str
        The file; empty where there is none (typed at a prompt).
    text : str
        The file's text.
    """

    path: str
    text: str

    @property
    def digest(self) -> str:
        """Of the text."""
        return digest_of(self.text)

    def describe(self, machine: FromPage) -> dict[str, Any]:
        """Path, object, text and digest, ready for JSON."""
        return {"page": self.path, "object": object_name(machine), "source": self.text, "digest": self.digest}


def again(path: str, name: str) -> object:
    """A machine in another process, which runs the page itself."""
    return getattr(module_of(path), name)


def digest_of(text: str) -> str:
    """A short digest of a declared machine's text."""
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def page_of(function: Callable) -> Page:
    """The file in which a function was written."""
    path = ""
    try:
        path = inspect.getsourcefile(function) or ""
        return Page(str(Path(path).resolve()), Path(path).read_text(encoding="utf-8"))
    except (TypeError, OSError, UnicodeDecodeError):
        return Page("", "")


def object_name(machine: FromPage) -> str:
    """The name under which the page's module holds the machine; empty where it does not."""
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if file and _resolved(str(file)) == machine.page.path:
            for name, value in vars(module).items():
                if value is machine:
                    return name
    return ""


@cache
def _resolved(path: str) -> str:
    """Without links and relative parts; asked of some thousand modules for every problem that is kept."""
    return str(Path(path).resolve())


class PageError(ValueError):
    """A declaration that is no machine; the sentence names the contact or field, what is wrong with it, and the way out."""


class States(Sequence["Plain"]):
    """The states as a page sees them: a sequence that also knows their names."""

    def __init__(self, names: Sequence[str], values: Sequence[Plain]) -> None:
        self._values = tuple(values)
        self.__dict__.update(zip(names, self._values))

    @overload
    def __getitem__(self, place: int) -> Plain: ...
    @overload
    def __getitem__(self, place: slice) -> tuple[Plain, ...]: ...
    def __getitem__(self, place: int | slice) -> Plain | tuple[Plain, ...]:
        return self._values[place]

    def __len__(self) -> int:
        return len(self._values)

    def __getattr__(self, name: str) -> Plain:
        known = ", ".join(k for k in self.__dict__ if k != "_values")
        raise PageError(f"state.{name}: there is no state of this name; the states are {known}")


class Named:
    """Parameters, or contact forces and signs, by name; an unknown one is refused with a sentence."""

    def __init__(self, what: str, values: Mapping[str, Plain]) -> None:
        self._what = what
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> Plain:
        known = ", ".join(k for k in self.__dict__ if k != "_what")
        raise PageError(
            f"{self._what}.{name}: the machine declares no such {'parameter' if self._what == 'p' else 'contact'}; "
            f"it has {known or 'none'}"
        )


class NoPhase:
    """Stands for the phase of a self-excited machine, which has none."""

    def _refuse(self, *_: object) -> NoReturn:
        raise PageError(
            "phase: a self-excited machine (phase_rate=None) has no forcing phase; leave it out of the formulas, or "
            "name the parameter that is the forcing's frequency as phase_rate"
        )

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = _refuse
    __pow__ = __neg__ = __float__ = __array__ = _refuse


def called(what: str, function: object, *arguments: object) -> object:
    if not callable(function):
        given = "state, phase, p, contact" if what == "motion" else "state, phase, p"
        raise PageError(f"{what} is {function!r}; give a function, for example lambda {given}: ...")
    try:
        return function(*arguments)
    except PageError:
        raise
    except TypeError as error:
        says = str(error)
        hint = ""
        if "callable cos" in says or "has no callable" in says or "must be real number" in says:
            hint = "; take cos, sin, sqrt, exp ... from orbits.symbols"
        elif "positional argument" in says:
            given = "(state, phase, p, contact)" if what == "motion" else "(state, phase, p)"
            hint = f"; it is called with {given}"
        raise PageError(f"{what}: {says}{hint}") from error
    except (ValueError, ArithmeticError, IndexError, KeyError, AttributeError, NameError) as error:
        raise PageError(f"{what}: {error}") from error
