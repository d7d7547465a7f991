"""How an extra of the package is installed: from where the package itself came."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType


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
