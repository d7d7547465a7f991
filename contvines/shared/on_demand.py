"""Imports on first use: names of a package from its modules, and optional packages, with the command that installs them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType


def on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], object]:
    """Return a ``__getattr__`` for a package that imports names on first use.

    Parameters
    ----------
    package : str
        Name of the package.
    homes : mapping
        Module of each name. For a name with the module ``package.name``, the module itself is returned.
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
    """Return the command that installs an extra, from the same source as the package: PyPI, or a local folder."""
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
    """Import and return a package that an extra installs.

    Raises
    ------
    ValueError
        If it is not installed; the message has the command that installs it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ValueError(f"this needs {name}, which is not installed: {pip_install(extra)}") from None
