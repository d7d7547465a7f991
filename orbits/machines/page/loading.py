"""Machines from files: a page is run, and the machine that it names is taken."""

from __future__ import annotations

import copyreg
import importlib.util
import sys
from pathlib import Path
from typing import Any

from orbits.machines.page.machine import Machine
from orbits.machines.page.page import digest_of, object_name


def load_page(path: str | Path, name: str) -> Any:
    """Run a page and take the machine that it names.

    The page is Python and is run: only call this for a file that the user has named.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, it does not run, or has no machine of that name.
    """
    file = Path(path).resolve()
    if not file.is_file():
        raise FileNotFoundError(f"{path}: there is no such file; name the file that declares the machine")
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
            raise ValueError(
                f"{path}: the machine file does not run: {type(error).__name__}: {error}"
            ) from error
    machine = getattr(module, name, None)
    if not isinstance(machine, Machine):
        known = [key for key, value in vars(module).items() if isinstance(value, Machine)]
        raise ValueError(f"{path}: it has no machine {name!r}; it declares {', '.join(known) or 'none'}")
    return machine


def _again(machine: Machine) -> tuple[Any, tuple[str, str]]:
    """How another process gets the machine: it runs the page itself."""
    return load_page, (machine.page.path, object_name(machine))


copyreg.pickle(Machine, _again)
