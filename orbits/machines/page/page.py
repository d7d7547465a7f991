"""The page behind a declared machine: its file, its text, and whether it has changed since."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from contvines.shared.python_files import module_of


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
