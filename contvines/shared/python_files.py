"""Python files that a user names, and what is in them."""

from __future__ import annotations

import hashlib
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


def module_of(path: str | Path) -> ModuleType:
    """The module that a Python file makes when it is run, once in a process as long as its text stays.

    Only for a file that the user has named.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no Python file, or does not run.
    """
    file = Path(path).resolve()
    digest = hashlib.sha256(str(file).encode() + file.read_bytes()).hexdigest()[:16]
    name = f"_own_{file.stem}_{digest}"
    if name not in sys.modules:
        spec = spec_from_file_location(name, file)
        if spec is None or spec.loader is None:
            raise ValueError(f"{path}: this is no Python file")
        module = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[name]
            raise ValueError(f"{path}: the file does not run: {type(error).__name__}: {error}") from error
    return sys.modules[name]


def names_of(module: ModuleType, kind: type) -> list[str]:
    """Under which names a module has things of a kind."""
    return [name for name, value in vars(module).items() if isinstance(value, kind)]
