"""What is imported when it is first asked for: names of a package, and packages of an extra, with how one is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType


def on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], object]:
    """The ``__getattr__`` of a package: each name is taken from the module that holds it; ``homes`` has the modules by name.

    A home that is a module of the name itself is handed out whole.
    """

    def find(name: str) -> object:
        if name not in homes:
            if name.startswith("_"):
                raise AttributeError(f"{package} has no {name!r}")
            from contvines.shared.near_names import did_you_mean

            raise AttributeError(
                f"{package} has no {name!r}{did_you_mean(name, homes)}; it has {', '.join(sorted(homes))}"
            )
        home = import_module(homes[name])
        found = home if homes[name] == f"{package}.{name}" else getattr(home, name)
        setattr(sys.modules[package], name, found)
        return found

    return find


def pip_install(extra: str) -> str:
    """The command that adds an extra to the package as it is installed: from PyPI, or from the copy that `pip install .` was given."""
    import json
    from importlib.metadata import PackageNotFoundError, distribution
    from pathlib import Path
    from urllib.parse import urlparse
    from urllib.request import url2pathname

    source = "contvines"
    try:
        origin = json.loads(distribution("contvines").read_text("direct_url.json") or "{}").get("url", "")
    except PackageNotFoundError:  # used from a copy that is not installed
        origin = ""
    if origin.startswith("file:"):
        path = Path(url2pathname(urlparse(origin).path))
        source = "." if path == Path.cwd() else str(path) if path.exists() else source
    return f'pip install "{source}[{extra}]"'


def needed(name: str, extra: str) -> ModuleType:
    """A package of an extra.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ValueError(f"this needs {name}, which is not installed: {pip_install(extra)}") from None
