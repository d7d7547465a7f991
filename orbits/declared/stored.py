"""Problems of declared machines from what a file keeps of them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from orbits.declared.problem import DeclaredProblem
from orbits.machines.page.loading import load_page
from orbits.machines.page.machine import Machine
from orbits.machines.page.page import digest_of
from orbits.words.of_pages import PageWord


class PageChanged(OSError):
    """The page of a stored machine is gone or has changed; the sentence says what would do."""


def page_changed(settings: dict[str, Any]) -> str:
    """A sentence if the page of a stored machine is gone or has changed since; empty if it is as it was."""
    path = Path(settings["page"])
    if not settings["page"]:
        return "the machine was declared at a prompt, so its page cannot be found again: declare it in a file"
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        return f"{path}: the page that declared the machine is gone; put it back (the result keeps its text), or make the result anew"
    if digest_of(text) != settings["digest"]:
        return (
            f"{path}: the page has changed since the result was made; put the text back that was used (the result keeps it), "
            "or make the result anew"
        )
    return ""


def loaded(settings: dict[str, Any]) -> Machine | None:
    """The machine, if its page has been run in this process already."""
    for module in list(sys.modules.values()):
        if getattr(module, "__file__", None) is None:
            continue
        value = vars(module).get(settings["object"]) if settings["object"] else None
        if isinstance(value, Machine) and value.page.digest == settings["digest"]:
            return value
    return None


def rebuild(description: dict[str, Any], trust: bool = False) -> DeclaredProblem | None:
    """The problem that `DeclaredProblem.describe` described.

    A machine that this process has already is taken as it is. Else its page has to be run: only with `trust`; without it the
    answer is None.

    Raises
    ------
    PageChanged
        If the page is gone or has changed.
    """
    settings = description["model"]
    machine = loaded(settings)
    if machine is None:
        if not trust:
            return None
        problem = page_changed(settings)
        if problem:
            raise PageChanged(problem)
        machine = load_page(settings["page"], settings["object"])
    word = PageWord(tuple(description["events"]), tuple(map(tuple, description["modes"])), machine.alphabet)
    return DeclaredProblem(
        machine,
        word,
        description["periods"],
        description["parameter"],
        np.array(description["params"]),
        description["symmetric"],
    )
