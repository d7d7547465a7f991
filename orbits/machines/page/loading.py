"""Machines from machine files: the file is executed, and the named machine is taken."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from contvines.shared.files import module_of, names_of
from orbits.machines.names import PAGES, page_machine
from orbits.machines.page.machine import Machine
from orbits.machines.page.page import digest_of


def load_page(path: str | Path, name: str) -> Machine:
    """Execute a machine file and return the machine with a name.

    The file is Python code: only call this for a file that the user has named.

    Raises
    ------
    FileNotFoundError, ValueError
        If the file is missing, fails, or has no machine of that name.
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
        names = ", ".join(names_of(module, Machine)) or "none"
        raise ValueError(f"{path}: it has no machine {name!r}; it declares {names}")
    return machine


class PageChanged(OSError):
    """The file of a stored machine is missing or has changed; the message gives the remedy."""


def page_changed(settings: dict[str, Any]) -> str:
    """Return a sentence if the file of a stored machine is missing or has changed; empty if it is unchanged."""
    path = Path(settings["page"])
    if _is_packaged(settings):
        return ""
    if not settings["page"]:
        return "the machine was declared at a prompt, so that it cannot be found again: declare it in a file"
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        return f"{path}: the file that declared the machine is gone; put it back, or beside the result (which keeps its text), or make the result anew"
    if digest_of(text) != settings["digest"]:
        return (
            f"{path}: the machine file has changed since the result was made; put the text back that was used (the result keeps it), "
            "or make the result anew"
        )
    return ""


def _is_packaged(settings: dict[str, Any]) -> bool:
    """Return whether the machine is one of the package's own, which is identified by its name even if its file has changed."""
    path = Path(settings["page"])
    return settings["object"] in PAGES and path.parts[-3:] == (
        "orbits",
        "machines",
        f"{settings['object']}.py",
    )


def loaded(settings: dict[str, Any]) -> Machine | None:
    """Return the machine if its file has already been executed in this process."""
    for module in list(sys.modules.values()):
        if getattr(module, "__file__", None) is None:
            continue
        value = vars(module).get(settings["object"]) if settings["object"] else None
        if isinstance(value, Machine) and value.page.digest == settings["digest"]:
            return value
    return None


def machine_again(settings: dict[str, Any], trust: bool) -> Machine | None:
    """Return the machine with these settings: the one of this process, or, only with `trust`, that of its file; else None.

    Raises
    ------
    PageChanged
        If the machine file is missing or has changed.
    """
    machine = loaded(settings)
    if machine is None and _is_packaged(settings):
        found = page_machine(settings["object"])
        machine = found if isinstance(found, Machine) else None
    if machine is not None or not trust:
        return machine
    problem = page_changed(settings)
    if problem:
        raise PageChanged(problem)
    return load_page(settings["page"], settings["object"])
