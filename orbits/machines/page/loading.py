"""Machines from files: a page is run, and the machine that it names is taken."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from contvines.shared.files import module_of, names_of
from orbits.machines.names import PAGES, page_machine
from orbits.machines.page.machine import Machine
from orbits.machines.page.page import digest_of


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


class PageChanged(OSError):
    """The file of a stored machine is gone or has changed; the sentence says the way out."""


def page_changed(settings: dict[str, Any]) -> str:
    """A sentence if the page of a stored machine is gone or has changed since; empty if it is as it was."""
    path = Path(settings["page"])
    if _comes_along(settings):
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


def _comes_along(settings: dict[str, Any]) -> bool:
    """Whether the machine is one of the package's own: its name says what it is, whatever else its page says now."""
    path = Path(settings["page"])
    return settings["object"] in PAGES and path.parts[-3:] == (
        "orbits",
        "machines",
        f"{settings['object']}.py",
    )


def loaded(settings: dict[str, Any]) -> Machine | None:
    """The machine, if its machine file has been run in this process already."""
    for module in list(sys.modules.values()):
        if getattr(module, "__file__", None) is None:
            continue
        value = vars(module).get(settings["object"]) if settings["object"] else None
        if isinstance(value, Machine) and value.page.digest == settings["digest"]:
            return value
    return None


def machine_again(settings: dict[str, Any], trust: bool) -> Machine | None:
    """The machine with these settings: the one that this process has, or, only with `trust`, that of its page; else None.

    Raises
    ------
    PageChanged
        If the machine file is gone or has changed.
    """
    machine = loaded(settings)
    if machine is None and _comes_along(settings):
        found = page_machine(settings["object"])
        machine = found if isinstance(found, Machine) else None
    if machine is not None or not trust:
        return machine
    problem = page_changed(settings)
    if problem:
        raise PageChanged(problem)
    return load_page(settings["page"], settings["object"])
