"""The machine file (page) behind a declared machine, its text and digest; and the arguments that its functions receive."""

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
    """A machine declared in a machine file."""

    @property
    def page(self) -> Page: ...


@dataclass(frozen=True)
class Page:
    """The file in which a machine was declared.

    Attributes
    ----------
    path : str
        The file; empty if there is none (typed at a prompt).
    text : str
        The file's text.
    """

    path: str
    text: str

    @property
    def digest(self) -> str:
        """Digest of the text."""
        return digest_of(self.text)

    def describe(self, machine: FromPage) -> dict[str, Any]:
        """Return path, object, text and digest, ready for JSON."""
        return {"page": self.path, "object": object_name(machine), "source": self.text, "digest": self.digest}


def again(path: str, name: str) -> object:
    """Return a machine in another process, which executes the machine file."""
    return getattr(module_of(path), name)


def digest_of(text: str) -> str:
    """Return a short digest of a machine file's text."""
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def page_of(function: Callable) -> Page:
    """Return the file in which a function was written."""
    path = ""
    try:
        path = inspect.getsourcefile(function) or ""
        return Page(str(Path(path).resolve()), Path(path).read_text(encoding="utf-8"))
    except (TypeError, OSError, UnicodeDecodeError):
        return Page("", "")


def object_name(machine: FromPage) -> str:
    """Return the name of the machine in the module of its file; empty if there is none."""
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if file and _resolved(str(file)) == machine.page.path:
            for name, value in vars(module).items():
                if value is machine:
                    return name
    return ""


@cache
def _resolved(path: str) -> str:
    """Return the path without links and relative parts; cached, because it is needed for some thousand modules at a time."""
    return str(Path(path).resolve())


class PageError(ValueError):
    """An invalid declaration of a machine; the message names the contact or field, the fault and the remedy."""


class States(Sequence["Plain"]):
    """The states as the functions of a machine file receive them: a sequence with named attributes."""

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
        names = ", ".join(k for k in self.__dict__ if k != "_values")
        raise PageError(f"state.{name}: there is no state of this name; the states are {names}")


class Named:
    """Parameters, or contact forces and signs, as attributes; an unknown name raises PageError."""

    def __init__(self, what: str, values: Mapping[str, Plain]) -> None:
        self._what = what
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> Plain:
        names = ", ".join(k for k in self.__dict__ if k != "_what")
        raise PageError(
            f"{self._what}.{name}: the machine declares no such {'parameter' if self._what == 'p' else 'contact'}; "
            f"it has {names or 'none'}"
        )


class NoPhase:
    """Placeholder for the phase of a self-excited machine; its use raises PageError."""

    def _refuse(self, *_: object) -> NoReturn:
        raise PageError(
            "phase: a self-excited machine (phase_rate=None) has no forcing phase; leave it out of the formulas, or "
            "name the parameter that is the forcing's frequency as phase_rate"
        )

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = _refuse
    __pow__ = __neg__ = __float__ = __array__ = _refuse


def called(label: str, function: object, *arguments: object) -> object:
    if not callable(function):
        given = "state, phase, p, contact" if label == "motion" else "state, phase, p"
        raise PageError(f"{label} is {function!r}; give a function, for example lambda {given}: ...")
    try:
        return function(*arguments)
    except PageError:
        raise
    except TypeError as error:
        message = str(error)
        hint = ""
        if "callable cos" in message or "has no callable" in message or "must be real number" in message:
            hint = "; take cos, sin, sqrt, exp ... from orbits.symbols"
        elif "positional argument" in message:
            given = "(state, phase, p, contact)" if label == "motion" else "(state, phase, p)"
            hint = f"; it is called with {given}"
        raise PageError(f"{label}: {message}{hint}") from error
    except (ValueError, ArithmeticError, IndexError, KeyError, AttributeError, NameError) as error:
        raise PageError(f"{label}: {error}") from error
