"""Machines from files: a page is run, and the machine that it names is taken."""

from __future__ import annotations

from pathlib import Path

from contvines.shared.python_files import module_of, names_of
from orbits.machines.page.machine import Machine


def load_page(path: str | Path, name: str) -> Machine:
    """Run a page and take the machine that it names.

    The page is Python and is run: only call this for a file that the user has named.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, it does not run, or has no machine of that name.
    """
    try:
        module = module_of(path)
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path}: there is no such file; name the file that declares the machine"
        ) from None
    machine = getattr(module, name, None)
    if not isinstance(machine, Machine):
        if machine is not None:
            kind = type(machine).__name__
            raise ValueError(
                f"{path}: {name} is a {kind}; an orbits.Machine or a contvines.FlowProblem is expected"
            )
        known = ", ".join(names_of(module, Machine)) or "none"
        raise ValueError(f"{path}: it has no machine {name!r}; it declares {known}")
    return machine
