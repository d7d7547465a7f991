"""The page behind a declared machine: its file, its text, and whether it has changed since."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


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

    def describe(self, machine: Any) -> dict[str, Any]:
        """Path, object, text and digest, ready for JSON."""
        return {"page": self.path, "object": object_name(machine), "source": self.text, "digest": self.digest}


def digest_of(text: str) -> str:
    """A short digest of a page's text."""
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def page_of(function: Callable) -> Page:
    """The file in which a function was written."""
    path = ""
    try:
        path = inspect.getsourcefile(function) or ""
        return Page(str(Path(path).resolve()), Path(path).read_text(encoding="utf-8"))
    except (TypeError, OSError, UnicodeDecodeError):
        return Page("", "")


def object_name(machine: Any) -> str:
    """The name under which the page's module holds the machine; empty where it does not."""
    for module in list(sys.modules.values()):
        if (
            getattr(module, "__file__", None)
            and str(Path(str(module.__file__)).resolve()) == machine.page.path
        ):
            for name, value in vars(module).items():
                if value is machine:
                    return name
    return ""


def load_page(path: str | Path, name: str) -> Any:
    """Run a page and take the machine that it names.

    The page is Python and is run: only call this for a file that the user has named.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, it does not run, or has no machine of that name.
    """
    from orbits.machines.declared.machine import Machine

    file = Path(path).resolve()
    if not file.is_file():
        raise FileNotFoundError(f"{path}: there is no such file; name the page that declares the machine")
    text = file.read_text(encoding="utf-8")
    module_name = f"_page_{file.stem}_{digest_of(str(file) + text)}"
    module = sys.modules.get(module_name)
    if module is None:
        spec = importlib.util.spec_from_file_location(module_name, file)
        if spec is None or spec.loader is None:
            raise ValueError(f"{path} is no Python file")
        module = importlib.util.module_from_spec(spec)
        sys.modules[module_name] = module
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[module_name]
            raise ValueError(f"{path}: the page does not run: {type(error).__name__}: {error}") from error
    machine = getattr(module, name, None)
    if not isinstance(machine, Machine):
        known = [key for key, value in vars(module).items() if isinstance(value, Machine)]
        raise ValueError(f"{path}: it has no machine {name!r}; it declares {', '.join(known) or 'none'}")
    return machine
